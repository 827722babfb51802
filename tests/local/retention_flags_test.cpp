#include "pleat/local/retention_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pleat {
namespace {

TEST(RetentionFlagsTest, WithoutFlagsNothingThatIsWholeGoes) {
  const RetentionRules rules = RulesOf({});
  EXPECT_EQ(rules.max_ended_jobs, 0);
  EXPECT_EQ(rules.max_job_age, absl::InfiniteDuration());
  EXPECT_EQ(rules.max_upload_age, absl::Hours(168));
}

TEST(RetentionFlagsTest, DaysAndHoursBecomeRules) {
  const RetentionRules rules =
      RulesOf({.keep_jobs = 5, .keep_jobs_days = .5, .keep_uploads_hours = 0});
  EXPECT_EQ(rules.max_ended_jobs, 5);
  EXPECT_EQ(rules.max_job_age, absl::Hours(12));
  EXPECT_EQ(rules.max_upload_age, absl::ZeroDuration());
}

TEST(RetentionFlagsTest, EachIsVisitedWithARangeThatItsDefaultIsIn) {
  RetentionFlags flags;
  std::vector<std::string> names;
  VisitRetentionFlags(
      flags, 1, [&](const char* flag, auto& value, const char* help, double least, double most) {
        names.emplace_back(flag);
        EXPECT_STRNE(help, "");
        EXPECT_LE(least, static_cast<double>(value));
        EXPECT_LT(static_cast<double>(value), most);
      });
  EXPECT_THAT(names,
              testing::ElementsAre("--keep-jobs", "--keep-jobs-days", "--keep-uploads-hours"));
}

}  // namespace
}  // namespace pleat
