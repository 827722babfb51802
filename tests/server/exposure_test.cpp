#include "exposure.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ExposureTest, LocalAddressesNeedNoFlag) {
  for (const char* listen :
       {"127.0.0.1:7320", "localhost:7320", "[::1]:7320", "unix:/run/socket"}) {
    EXPECT_THAT(CheckExposure({.listen = listen, .is_root = true}), IsOk());
  }
}

TEST(ExposureTest, PlainTextForOthersMustBeAskedFor) {
  Exposure exposure{.listen = "0.0.0.0:7320", .knows_callers = true};
  EXPECT_THAT(CheckExposure(exposure),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-unencrypted")));
  exposure.allow_unencrypted = true;
  EXPECT_THAT(CheckExposure(exposure), IsOk());
  EXPECT_THAT(CheckExposure({.listen = "0.0.0.0:7320", .encrypted = true, .knows_callers = true}),
              IsOk());
}

TEST(ExposureTest, CallersWhomNobodyKnowsMustBeAskedFor) {
  Exposure exposure{.listen = "0.0.0.0:7320", .encrypted = true};
  EXPECT_THAT(CheckExposure(exposure),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-anonymous")));
  exposure.allow_anonymous = true;
  EXPECT_THAT(CheckExposure(exposure), IsOk());
}

TEST(ExposureTest, RootForOthersMustBeAskedFor) {
  Exposure exposure{
      .listen = "0.0.0.0:7320", .encrypted = true, .knows_callers = true, .is_root = true};
  EXPECT_THAT(CheckExposure(exposure),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-root")));
  exposure.allow_root = true;
  EXPECT_THAT(CheckExposure(exposure), IsOk());
}

}  // namespace
}  // namespace pleat
