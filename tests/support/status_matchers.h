// Matchers for absl::Status and absl::StatusOr.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

inline constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

inline absl::Status ToStatus(const absl::Status& status) { return status; }
template <typename T>
absl::Status ToStatus(const absl::StatusOr<T>& status_or) {
  return status_or.status();
}

// EXPECT_THAT(ReadMesh(path), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex")));
MATCHER_P2(HasStatus, code, message_matcher, "") {
  const absl::Status status = ToStatus(arg);
  *result_listener << "whose status is " << status.ToString();
  return status.code() == code &&
         ::testing::ExplainMatchResult(message_matcher, std::string(status.message()),
                                       result_listener);
}

MATCHER(IsOk, "is OK") {
  *result_listener << "whose status is " << ToStatus(arg).ToString();
  return ToStatus(arg).ok();
}

}  // namespace pleat

#define PLEAT_TEST_CONCAT_INNER(a, b) a##b
#define PLEAT_TEST_CONCAT(a, b) PLEAT_TEST_CONCAT_INNER(a, b)
// PLEAT_ASSERT_OK_AND_ASSIGN(auto mesh, ReadMesh(path));
#define PLEAT_ASSERT_OK_AND_ASSIGN(declaration, expression) \
  auto PLEAT_TEST_CONCAT(result_, __LINE__) = (expression); \
  ASSERT_TRUE(PLEAT_TEST_CONCAT(result_, __LINE__).ok())    \
      << PLEAT_TEST_CONCAT(result_, __LINE__).status();     \
  declaration = std::move(PLEAT_TEST_CONCAT(result_, __LINE__)).value()
