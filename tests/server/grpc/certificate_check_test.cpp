#include "certificate_check.h"

#include <gtest/gtest.h>

#include <ctime>

#include "pleat/base/file.h"
#include "support/certificates.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

auto Refused(const std::string& why) {
  return HasStatus(absl::StatusCode::kUnavailable, HasSubstr(why));
}

TEST(CertificateCheckTest, WhatBelongsTogetherIsTaken) {
  const Certificate authority = Certificate::Authority("studio");
  const Certificate own = Certificate::SignedBy(authority, "server");
  EXPECT_THAT(CheckCertificates(own.certificate_pem(), own.key_pem(), ""), IsOk());
  EXPECT_THAT(CheckCertificates(own.certificate_pem(), own.key_pem(), authority.certificate_pem()),
              IsOk());
}

TEST(CertificateCheckTest, EachFaultIsNamed) {
  const Certificate one = Certificate::Authority("one"), two = Certificate::Authority("two");
  EXPECT_THAT(CheckCertificates("no PEM", one.key_pem(), ""), Refused("no PEM certificate"));
  EXPECT_THAT(CheckCertificates("", one.key_pem(), ""), Refused("no PEM certificate"));
  EXPECT_THAT(CheckCertificates(one.certificate_pem(), "no PEM", ""), Refused("no PEM key"));
  EXPECT_THAT(CheckCertificates(one.certificate_pem(), one.certificate_pem(), ""),
              Refused("no PEM key"));
  EXPECT_THAT(CheckCertificates(one.certificate_pem(), two.key_pem(), ""),
              Refused("do not fit together"));
  EXPECT_THAT(CheckCertificates(one.certificate_pem(), one.key_pem(), "no PEM"),
              Refused("authority"));
}

TEST(CertificateCheckTest, FilesAreCheckedAsTheirTexts) {
  TemporaryFolder folder;
  const Certificate one = Certificate::Authority("one");
  const std::string certificate = folder.path() + "/c.pem", key = folder.path() + "/k.pem",
                    empty = folder.path() + "/empty.pem";
  ASSERT_THAT(WriteFile(certificate, one.certificate_pem()), IsOk());
  ASSERT_THAT(WriteFile(key, one.key_pem()), IsOk());
  ASSERT_THAT(WriteFile(empty, ""), IsOk());
  EXPECT_THAT(CheckCertificateFiles(certificate, key, ""), IsOk());
  EXPECT_THAT(CheckCertificateFiles(certificate, key, certificate), IsOk());
  EXPECT_THAT(CheckCertificateFiles(certificate, key, empty), Refused("authority"));
  EXPECT_THAT(CheckCertificateFiles(key, key, ""), Refused("no PEM certificate"));
  EXPECT_THAT(CheckCertificateFiles(certificate, folder.path() + "/none", ""),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("/none")));
}

TEST(CertificateCheckTest, KnowsWhenACertificateExpires) {
  const Certificate one = Certificate::Authority("one");  // good for an hour
  const auto now = std::time(nullptr);
  const std::optional<int64_t> expiry = CertificateExpiry(one.certificate_pem());
  ASSERT_TRUE(expiry.has_value());
  EXPECT_NEAR(static_cast<double>(*expiry - now), 3600, 60);
  EXPECT_EQ(CertificateExpiry(one.key_pem()), std::nullopt);
  EXPECT_EQ(CertificateFileExpiry("/no/such/file"), std::nullopt);
}

}  // namespace
}  // namespace pleat
