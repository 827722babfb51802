// SHA-256 for content ids and checksums, by OpenSSL.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace pleat {

using Sha256Digest = std::array<uint8_t, 32>;

// An incremental hash for data that arrives in chunks. A moved-from object may only be assigned to
// or destroyed.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Update(std::string_view bytes);
  Sha256Digest Finish();  // call once

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

// Returns the digest of `bytes` in one call.
Sha256Digest ComputeSha256(std::string_view bytes);

// Returns 64 lower-case hexadecimal digits.
std::string ToHex(const Sha256Digest& digest);

}  // namespace pleat
