#include "murmur_hash.h"

#include <bit>
#include <cstring>

namespace pleat {
namespace {

constexpr uint64_t kMultiplier1 = 0x87c37b91114253d5, kMultiplier2 = 0x4cf5ad432745937f;

uint64_t Mix1(uint64_t word) { return std::rotl(word * kMultiplier1, 31) * kMultiplier2; }
uint64_t Mix2(uint64_t word) { return std::rotl(word * kMultiplier2, 33) * kMultiplier1; }

// Spreads every bit over all others.
uint64_t Avalanche(uint64_t word) {
  word = (word ^ (word >> 33)) * 0xff51afd7ed558ccd;
  word = (word ^ (word >> 33)) * 0xc4ceb9fe1a85ec53;
  return word ^ (word >> 33);
}

uint64_t WholeWord(const char* bytes) {
  uint64_t word;
  std::memcpy(&word, bytes, sizeof(word));
  return word;
}

// At most eight bytes as a number, zeros behind them.
uint64_t PartOfWord(std::string_view bytes) {
  uint64_t word = 0;
  if (!bytes.empty()) std::memcpy(&word, bytes.data(), bytes.size());
  return word;
}

}  // namespace

std::array<uint64_t, 2> MurmurHash3(std::string_view bytes) {
  uint64_t first = 0, second = 0;
  const uint64_t length = bytes.size();
  for (; bytes.size() >= 16; bytes.remove_prefix(16)) {
    first ^= Mix1(WholeWord(bytes.data()));
    first = (std::rotl(first, 27) + second) * 5 + 0x52dce729;
    second ^= Mix2(WholeWord(bytes.data() + 8));
    second = (std::rotl(second, 31) + first) * 5 + 0x38495ab5;
  }
  // A rest of zero words changes nothing.
  first ^= Mix1(PartOfWord(bytes.substr(0, 8)));
  if (bytes.size() > 8) second ^= Mix2(PartOfWord(bytes.substr(8)));
  first ^= length;
  second ^= length;
  first += second;
  second += first;
  first = Avalanche(first);
  second = Avalanche(second);
  first += second;
  second += first;
  return {first, second};
}

}  // namespace pleat
