#include "murmur_hash.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

namespace pleat {
namespace {

std::string HexOf(const std::array<uint64_t, 2>& digest) {
  std::string hex;
  for (size_t i = 0; i < sizeof(digest); ++i) {
    const auto byte = reinterpret_cast<const unsigned char*>(digest.data())[i];
    hex.push_back("0123456789abcdef"[byte >> 4]);
    hex.push_back("0123456789abcdef"[byte & 15]);
  }
  return hex;
}

// The keys that the reference library of Alembic wrote in front of these samples.
TEST(MurmurHashTest, GivesTheKeysOfTheReferenceLibrary) {
  EXPECT_EQ(HexOf(MurmurHash3("\x01")), "16fe7483905cce7a85670e43e4678877");
  EXPECT_EQ(HexOf(MurmurHash3(std::string_view("\x0c\0\0\0", 4))),
            "6180982693d0825e32c5b8362f667d8e");
  EXPECT_EQ(HexOf(MurmurHash3(std::string_view("\0\0\0\0\1\0\0\0\2\0\0\0\3\0\0\0", 16))),
            "d15bd55e1bb88097646f409b63d099e2");
  EXPECT_EQ(HexOf(MurmurHash3(std::string_view("\2\0\0\0\1\0\0\0\0\0\0\0", 12))),
            "395b06ea4831a46b1658804e565ebd04");
}

TEST(MurmurHashTest, EveryLengthAndEveryBitCounts) {
  std::set<std::array<uint64_t, 2>> digests;
  std::string bytes(40, 'a');
  for (size_t length = 0; length <= bytes.size(); ++length) {
    EXPECT_TRUE(digests.insert(MurmurHash3(std::string_view(bytes).substr(0, length))).second);
  }
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string changed = bytes;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
    EXPECT_TRUE(digests.insert(MurmurHash3(changed)).second) << bit;
  }
}

}  // namespace
}  // namespace pleat
