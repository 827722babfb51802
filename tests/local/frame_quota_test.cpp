#include "pleat/local/frame_quota.h"

#include <gtest/gtest.h>

#include "pleat/base/limit_refusal.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class FrameQuotaTest : public testing::Test {
 protected:
  absl::Duration WaitOf(const absl::Status& status) {
    const auto refusal = LimitRefusalOf(status);
    return refusal && refusal->retry_after ? *refusal->retry_after : absl::InfiniteDuration();
  }
  double now_ = 1000;
  FrameQuota quota_{30, "robots", [this] { return now_; }};
};

TEST_F(FrameQuotaTest, APaceWithinTheLimitIsNeverRefused) {
  for (int frame = 0; frame < 3000; ++frame) {
    EXPECT_THAT(quota_.Take(1), IsOk()) << frame;
    now_ += 1. / 30;
  }
}

TEST_F(FrameQuotaTest, TwoSecondsComeAtOnceAndThenNoMore) {
  int num_taken = 0;
  absl::Status status;
  while ((status = quota_.Take(1)).ok()) ++num_taken;
  EXPECT_EQ(num_taken, 60);
  EXPECT_THAT(status,
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("robots")));
  EXPECT_EQ(LimitRefusalOf(status)->subject, "project:robots");
  const absl::Duration wait = WaitOf(status);
  EXPECT_LE(wait, absl::Milliseconds(34));
  now_ += absl::ToDoubleSeconds(wait);
  EXPECT_THAT(quota_.Take(1), IsOk());  // it was told the truth
  now_ += 1e6;
  for (num_taken = 0; quota_.Take(1).ok();) ++num_taken;
  EXPECT_EQ(num_taken, 60);  // an idle day saves no more than that
}

TEST_F(FrameQuotaTest, AClipIsNeverCutAndPaidForAfterwards) {
  EXPECT_THAT(quota_.Take(3060), IsOk());
  const absl::Duration wait = WaitOf(quota_.Take(1));
  EXPECT_GE(wait, absl::Seconds(100));
  EXPECT_LE(wait, absl::Milliseconds(100'040));
  now_ += 100.04;
  EXPECT_THAT(quota_.Take(1), IsOk());
}

TEST_F(FrameQuotaTest, ZeroIsNoLimit) {
  FrameQuota none(0, "robots", [] { return 0.; });
  for (int i = 0; i < 10; ++i) EXPECT_THAT(none.Take(1'000'000), IsOk());
}

}  // namespace
}  // namespace pleat
