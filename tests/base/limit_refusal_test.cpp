#include "pleat/base/limit_refusal.h"

#include <gtest/gtest.h>

#include "pleat/base/status.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(LimitRefusalTest, AStatusCarriesIt) {
  const absl::Status status = RefuseForLimit({.subject = "project:robots",
                                              .limit = "--project-bytes",
                                              .retry_after = absl::Milliseconds(1500)},
                                             "no room");
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kResourceExhausted, "no room"));
  const auto refusal = LimitRefusalOf(status);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->subject, "project:robots");
  EXPECT_EQ(refusal->limit, "--project-bytes");
  EXPECT_EQ(refusal->retry_after, absl::Milliseconds(1500));
}

TEST(LimitRefusalTest, WaitingNeedNotHelp) {
  const auto refusal = LimitRefusalOf(RefuseForLimit({.limit = "--max-frames"}, "too long"));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->subject, kServerLimit);
  EXPECT_FALSE(refusal->retry_after);
}

TEST(LimitRefusalTest, ContextKeepsIt) {
  const auto refusal = LimitRefusalOf(
      WithContext("sequence 3", RefuseForLimit({.limit = "--max-frames"}, "too long")));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->limit, "--max-frames");
}

TEST(LimitRefusalTest, OtherErrorsHaveNone) {
  EXPECT_FALSE(LimitRefusalOf(absl::OkStatus()));
  EXPECT_FALSE(LimitRefusalOf(absl::ResourceExhaustedError("no memory")));
  absl::Status forged = absl::ResourceExhaustedError("x");
  forged.SetPayload("pleat/limit-refusal", absl::Cord("without lines"));
  EXPECT_FALSE(LimitRefusalOf(forged));
}

}  // namespace
}  // namespace pleat
