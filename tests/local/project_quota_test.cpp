#include "pleat/local/project_quota.h"

#include <gtest/gtest.h>

#include "pleat/base/limit_refusal.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class ProjectQuotaTest : public testing::Test {
 protected:
  absl::Duration WaitOf(const absl::Status& status) {
    const auto refusal = LimitRefusalOf(status);
    return refusal && refusal->retry_after ? *refusal->retry_after : absl::InfiniteDuration();
  }
  double now_ = 1000;
  ProjectQuota quota_{ProjectQuota::OfFrames("robots", 30), [this] { return now_; }};
};

TEST_F(ProjectQuotaTest, APaceWithinTheLimitIsNeverRefused) {
  for (int frame = 0; frame < 3000; ++frame) {
    EXPECT_THAT(quota_.Take(1), IsOk()) << frame;
    now_ += 1. / 30;
  }
}

TEST_F(ProjectQuotaTest, TwoSecondsComeAtOnceAndThenNoMore) {
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

TEST_F(ProjectQuotaTest, AClipIsNeverCutAndPaidForAfterwards) {
  EXPECT_THAT(quota_.Take(3060), IsOk());
  const absl::Duration wait = WaitOf(quota_.Take(1));
  EXPECT_GE(wait, absl::Seconds(100));
  EXPECT_LE(wait, absl::Milliseconds(100'040));
  now_ += 100.04;
  EXPECT_THAT(quota_.Take(1), IsOk());
}

TEST_F(ProjectQuotaTest, ZeroIsNoLimit) {
  ProjectQuota none(ProjectQuota::OfFrames("robots", 0), [] { return 0.; });
  for (int i = 0; i < 10; ++i) EXPECT_THAT(none.Take(1'000'000), IsOk());
}

TEST_F(ProjectQuotaTest, ALimitBelowOneInItsBurstIsALimitAndNotAWall) {
  ProjectQuota slow(ProjectQuota::OfFrames("robots", .1), [this] { return now_; });
  EXPECT_THAT(slow.Take(1), IsOk());
  EXPECT_FALSE(slow.Take(1).ok());
  now_ += 10;
  EXPECT_THAT(slow.Take(1), IsOk());
}

TEST_F(ProjectQuotaTest, AnHourOfJobsMayBeUsedAtOnceAndIsPaidForByTheHour) {
  ProjectQuota jobs(ProjectQuota::OfJobTime("robots", 7200), [this] { return now_; });
  EXPECT_EQ(jobs.TimeUntilFree(), absl::ZeroDuration());
  jobs.Charge(7000);
  EXPECT_EQ(jobs.TimeUntilFree(), absl::ZeroDuration());
  jobs.Charge(3800);  // a job that runs is never stopped: 3600 too many, half an hour's share
  EXPECT_NEAR(absl::ToDoubleSeconds(jobs.TimeUntilFree()), 1800, 1);
  const absl::Status status = jobs.Take(0);
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kResourceExhausted,
                                testing::HasSubstr("7200 seconds of processor time")));
  EXPECT_EQ(LimitRefusalOf(status)->limit, "--project-job-cpu-seconds-per-hour");
  EXPECT_NEAR(absl::ToDoubleSeconds(WaitOf(status)), 1800, 1);
  now_ += 1801;
  EXPECT_EQ(jobs.TimeUntilFree(), absl::ZeroDuration());
  EXPECT_THAT(jobs.Take(0), IsOk());
  EXPECT_EQ(jobs.used(), 10'800);
}

}  // namespace
}  // namespace pleat
