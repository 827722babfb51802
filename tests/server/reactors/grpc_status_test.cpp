#include "pleat/reactors/grpc_status.h"

#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/wire/limit_messages.h"

namespace pleat {
namespace {

TEST(GrpcStatus, CodesAreTheSameByNumber) {
  for (int code = 1; code <= 16; ++code) {
    const grpc::Status status =
        ToGrpcStatus(absl::Status(static_cast<absl::StatusCode>(code), "why"));
    EXPECT_EQ(static_cast<int>(status.error_code()), code);
    EXPECT_EQ(status.error_message(), "why");
  }
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus()).ok());
}

TEST(GrpcStatus, LongMessagesFitIntoATrailer) {
  const std::string longest(2000, 'x');
  EXPECT_EQ(ToGrpcStatus(absl::NotFoundError(longest)).error_message(), longest);
  EXPECT_EQ(ToGrpcStatus(absl::NotFoundError(absl::StrCat(longest, "yz"))).error_message(),
            longest + "...");
}

// gRPC ends the connection over a message that is no UTF-8, such as one that quotes hostile bytes
// or is cut inside of a character.
TEST(GrpcStatus, MessagesAreAlwaysUtf8) {
  EXPECT_EQ(ToGrpcStatus(absl::NotFoundError("a\xff"
                                             "b"))
                .error_message(),
            "a\xef\xbf\xbd"
            "b");
  const std::string cut =
      ToGrpcStatus(absl::NotFoundError(absl::StrCat(std::string(1999, 'x'), "\xc3\xa9 end")))
          .error_message();
  EXPECT_EQ(cut.substr(0, 1999), std::string(1999, 'x'));
  EXPECT_EQ(cut.find('\xc3'), std::string::npos);
}

TEST(GrpcStatus, RefusalsForALimitSayWhichAndWhenToComeAgain) {
  const grpc::Status refused = ToGrpcStatus(RefuseForLimit(
      {.subject = kClientLimit, .limit = "--x", .retry_after = absl::Seconds(2)}, "too many"));
  const auto refusal = LimitRefusalOf(
      WithLimitDetails(absl::ResourceExhaustedError("too many"), refused.error_details()));
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->limit, "--x");
  EXPECT_EQ(refusal->retry_after, absl::Seconds(2));
  EXPECT_EQ(ToGrpcStatus(absl::NotFoundError("x")).error_details(), "");
}

}  // namespace
}  // namespace pleat
