#include "exposure.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ExposureTest, LocalAddressesNeedNoFlag) {
  for (const char* listen : {"127.0.0.1:7320", "127.1.2.3:0", "localhost:7320", "[::1]:7320",
                             "unix:/run/pleat/socket"}) {
    EXPECT_TRUE(IsLocalAddress(listen)) << listen;
    EXPECT_THAT(CheckExposure({.listen = listen, .is_root = true}), IsOk());
  }
  for (const char* listen : {"0.0.0.0:7320", "[::]:7320", ":7320", "10.0.0.1:7320",
                             "studio.example:7320", "localhost.example:1", "7320"}) {
    EXPECT_FALSE(IsLocalAddress(listen)) << listen;
  }
}

TEST(ExposureTest, PlainTextForOthersMustBeAskedFor) {
  Exposure exposure{.listen = "0.0.0.0:7320"};
  EXPECT_THAT(CheckExposure(exposure),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-unencrypted")));
  exposure.allow_unencrypted = true;
  EXPECT_THAT(CheckExposure(exposure), IsOk());
  EXPECT_THAT(CheckExposure({.listen = "0.0.0.0:7320", .encrypted = true}), IsOk());
}

TEST(ExposureTest, RootForOthersMustBeAskedFor) {
  Exposure exposure{.listen = "0.0.0.0:7320", .encrypted = true, .is_root = true};
  EXPECT_THAT(CheckExposure(exposure),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-root")));
  exposure.allow_root = true;
  EXPECT_THAT(CheckExposure(exposure), IsOk());
}

}  // namespace
}  // namespace pleat
