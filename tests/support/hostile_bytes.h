// Damaged input for parsers: every truncation and many single-byte corruptions of a valid file.
#pragma once

#include <cstring>
#include <string>
#include <string_view>

#include "pleat/base/sha256.h"

namespace pleat {

// Calls decode(prefix) for every proper prefix of `bytes`.
template <typename Decode>
void ForEachTruncation(const std::string& bytes, Decode&& decode) {
  for (size_t length = 0; length < bytes.size(); ++length) {
    // A copy of exactly that size, so that a sanitizer sees a read beyond the end.
    decode(std::string(bytes.data(), length));
  }
}

// Calls decode(damaged) for every byte of `bytes` and several wrong values of it.
template <typename Decode>
void ForEachCorruption(const std::string& bytes, Decode&& decode) {
  std::string damaged = bytes;
  for (size_t i = 0; i < bytes.size(); ++i) {
    const auto original = static_cast<unsigned char>(bytes[i]);
    for (const int value : {0x00, 0xff, 0x7f, 0x80, original ^ 0x01, original ^ 0x10, int{'9'},
                            int{'-'}, int{'\n'}}) {
      if (value == original) continue;
      damaged[i] = static_cast<char>(value);
      decode(damaged);
    }
    damaged[i] = bytes[i];
  }
}

// Writes the right checksum over the last 32 bytes, so that damage reaches what lies behind it.
inline std::string Reseal(std::string bytes) {
  if (bytes.size() < 32) return bytes;
  const Sha256Digest digest = ComputeSha256(std::string_view(bytes).substr(0, bytes.size() - 32));
  std::memcpy(bytes.data() + bytes.size() - 32, digest.data(), 32);
  return bytes;
}

}  // namespace pleat
