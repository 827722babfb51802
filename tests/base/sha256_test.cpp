// Known answers from FIPS 180-4 / NIST CAVP.
#include "pleat/base/sha256.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(Sha256Test, KnownVectors) {
  EXPECT_EQ(ToHex(ComputeSha256("")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(ToHex(ComputeSha256("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(ToHex(ComputeSha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(ToHex(ComputeSha256(std::string(1'000'000, 'a'))),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256Test, ChunksGiveTheSameDigestAsTheWhole) {
  const std::string text(1000, 'x');
  Sha256 hash;
  for (size_t begin = 0; begin < text.size(); begin += 17) {
    hash.Update(std::string_view(text).substr(begin, 17));
  }
  EXPECT_EQ(hash.Finish(), ComputeSha256(text));
}

TEST(Sha256Test, MovedHashGoesOn) {
  Sha256 first;
  first.Update("ab");
  Sha256 second = std::move(first);
  second.Update("c");
  EXPECT_EQ(second.Finish(), ComputeSha256("abc"));
}

}  // namespace
}  // namespace pleat
