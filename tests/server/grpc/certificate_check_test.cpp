#include "certificate_check.h"

#include <gtest/gtest.h>

#include "support/certificates.h"
#include "support/status_matchers.h"

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

}  // namespace
}  // namespace pleat
