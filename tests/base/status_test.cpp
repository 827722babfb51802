#include "pleat/base/status.h"

#include <cerrno>
#include <memory>

#include "support/status_matchers.h"

namespace pleat {
namespace {

absl::StatusOr<int> Half(int value) {
  if (value % 2 != 0) return absl::InvalidArgumentError("odd");
  return value / 2;
}

absl::StatusOr<int> Quarter(int value) {
  PLEAT_ASSIGN_OR_RETURN(const int half, Half(value));
  PLEAT_ASSIGN_OR_RETURN(int quarter, Half(half));
  return quarter;
}

absl::Status CheckBoth(absl::Status first, absl::Status second, int* num_passed) {
  PLEAT_RETURN_IF_ERROR(first);
  ++*num_passed;
  PLEAT_RETURN_IF_ERROR(second);
  ++*num_passed;
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<int>> MovesOnly() {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<int> value,
                         absl::StatusOr<std::unique_ptr<int>>(std::make_unique<int>(3)));
  return value;
}

TEST(StatusTest, AssignOrReturnPassesValuesAndErrorsOn) {
  EXPECT_EQ(*Quarter(8), 2);
  EXPECT_THAT(Quarter(6), HasStatus(absl::StatusCode::kInvalidArgument, "odd"));
  EXPECT_THAT(Quarter(7), HasStatus(absl::StatusCode::kInvalidArgument, "odd"));
  EXPECT_EQ(**MovesOnly(), 3);
}

TEST(StatusTest, ReturnIfErrorStopsAtTheFirstError) {
  int num_passed = 0;
  EXPECT_THAT(CheckBoth(absl::OkStatus(), absl::OkStatus(), &num_passed), IsOk());
  EXPECT_EQ(num_passed, 2);
  num_passed = 0;
  EXPECT_THAT(CheckBoth(absl::OkStatus(), absl::InternalError("b"), &num_passed),
              HasStatus(absl::StatusCode::kInternal, "b"));
  EXPECT_EQ(num_passed, 1);
}

// Exit code 1 of `pleat` and INTERNAL of the server say that Pleat itself is wrong.
TEST(StatusTest, NoErrnoOfASystemCallIsUnknown) {
  for (int code = 1; code < 140; ++code) {
    const absl::Status status = ErrnoStatus(code, "cannot open 'a'");
    EXPECT_FALSE(status.ok()) << code;
    EXPECT_NE(status.code(), absl::StatusCode::kUnknown) << code;
    EXPECT_NE(status.code(), absl::StatusCode::kInternal) << code;
    EXPECT_NE(status.code(), absl::StatusCode::kDataLoss) << code;  // would be put in quarantine
    EXPECT_THAT(std::string(status.message()), testing::StartsWith("cannot open 'a': "));
  }
  EXPECT_THAT(ErrnoStatus(ELOOP, "a"),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("symbolic links")));
  EXPECT_EQ(ErrnoStatus(EIO, "a").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(ErrnoStatus(ENOENT, "a").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ErrnoStatus(ENOSPC, "a").code(), absl::StatusCode::kResourceExhausted);
}

TEST(StatusTest, WithContextNamesThePlaceOfAnErrorAndKeepsValues) {
  EXPECT_THAT(WithContext("a.obj", absl::OkStatus()), IsOk());
  EXPECT_THAT(WithContext("a.obj", absl::DataLossError("cut off")),
              HasStatus(absl::StatusCode::kDataLoss, "a.obj: cut off"));
  EXPECT_EQ(*WithContext("a.obj", Half(8)), 4);
  EXPECT_THAT(WithContext("a.obj", Half(7)),
              HasStatus(absl::StatusCode::kInvalidArgument, "a.obj: odd"));
}

}  // namespace
}  // namespace pleat
