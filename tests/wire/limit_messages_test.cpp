#include "pleat/wire/limit_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "pleat/base/limit_refusal.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(LimitMessagesTest, ARefusalArrivesAsItWasSent) {
  for (const auto& wait : {std::optional<absl::Duration>(), std::optional(absl::Milliseconds(1250)),
                           std::optional(absl::Minutes(3))}) {
    const absl::Status sent = RefuseForLimit(
        {.subject = "project:robots", .limit = "--project-bytes", .retry_after = wait}, "no room");
    const absl::Status plain(sent.code(), sent.message());  // what gRPC itself carries
    const absl::Status received = WithLimitDetails(plain, LimitDetailsOf(sent));
    EXPECT_THAT(received, HasStatus(absl::StatusCode::kResourceExhausted, "no room"));
    const auto refusal = LimitRefusalOf(received);
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->subject, "project:robots");
    EXPECT_EQ(refusal->limit, "--project-bytes");
    EXPECT_EQ(refusal->retry_after, wait);
  }
}

// Other programs read them by the field numbers of googleapis.
TEST(LimitMessagesTest, TheBytesAreThoseOfGoogleapis) {
  const std::string details =
      LimitDetailsOf(RefuseForLimit({.limit = "-l", .retry_after = absl::Seconds(2)}, "m"));
  const std::string quota = "type.googleapis.com/google.rpc.QuotaFailure";
  const std::string retry = "type.googleapis.com/google.rpc.RetryInfo";
  const std::string violation = std::string("\x0a\x06server\x12\x02-l");
  const std::string failure =
      "\x0a" + std::string(1, static_cast<char>(violation.size())) + violation;
  const std::string info = std::string("\x0a\x02\x08\x02");
  const auto any = [](const std::string& type, const std::string& value) {
    const std::string message = "\x0a" + std::string(1, static_cast<char>(type.size())) + type +
                                "\x12" + std::string(1, static_cast<char>(value.size())) + value;
    return "\x1a" + std::string(1, static_cast<char>(message.size())) + message;
  };
  EXPECT_EQ(details, std::string("\x08\x08\x12\x01m") + any(quota, failure) + any(retry, info));
}

TEST(LimitMessagesTest, OtherErrorsHaveNoDetailsAndHostileOnesChangeNothing) {
  EXPECT_EQ(LimitDetailsOf(absl::NotFoundError("x")), "");
  EXPECT_EQ(LimitDetailsOf(absl::ResourceExhaustedError("x")), "");
  const std::string good =
      LimitDetailsOf(RefuseForLimit({.limit = "-l", .retry_after = absl::Seconds(2)}, "m"));
  EXPECT_FALSE(LimitRefusalOf(WithLimitDetails(absl::NotFoundError("x"), good)));
  const absl::Status refused = absl::ResourceExhaustedError("x");
  for (size_t size = 0; size < good.size(); ++size) {
    EXPECT_THAT(WithLimitDetails(refused, good.substr(0, size)),
                HasStatus(absl::StatusCode::kResourceExhausted, "x"));
  }
  google::rpc::RetryInfo info;
  for (const int64_t seconds : {int64_t{-5}, std::numeric_limits<int64_t>::max()}) {
    info.mutable_retry_delay()->set_seconds(seconds);
    google::rpc::Status message;
    message.add_details()->PackFrom(info);
    const auto refusal = LimitRefusalOf(WithLimitDetails(refused, message.SerializeAsString()));
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->retry_after, seconds < 0 ? absl::ZeroDuration() : absl::Hours(24));
  }
}

}  // namespace
}  // namespace pleat
