#include "pleat/gp/kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(KernelTest, PackedLogsComeBack) {
  for (const bool bias : {false, true}) {
    for (const bool linear : {false, true}) {
      const KernelOptions options{.bias = bias, .linear = linear};
      Eigen::VectorXd unknowns(NumKernelUnknowns(options));
      PackKernelLogs(options, {1, 2, 3, 4, 5}, unknowns);
      const KernelLogs logs = UnpackKernelLogs(options, unknowns);
      EXPECT_EQ(logs.inverse_width, 1);
      EXPECT_EQ(logs.amplitude, 2);
      EXPECT_EQ(logs.noise, 4);
      EXPECT_EQ(logs.bias, bias ? 3 : KernelLogs{}.bias);
      EXPECT_EQ(logs.linear, linear ? 5 : KernelLogs{}.linear);
    }
  }
}

TEST(KernelTest, ValuesAreClampedAndTermsThatAreOffAreZero) {
  const KernelValues values = KernelValuesOf({.bias = false, .linear = false}, {99, -99, 3, 0, 3});
  EXPECT_EQ(values.g, std::exp(kMaxKernelLog));
  EXPECT_EQ(values.a, std::exp(-kMaxKernelLog));
  EXPECT_EQ(values.b, 0);
  EXPECT_EQ(values.s2, 1);
  EXPECT_EQ(values.c, 0);
}

TEST(KernelTest, ChecksActiveLogsOnly) {
  EXPECT_THAT(CheckKernelLogs({.bias = false}, {.bias = std::nan("")}, "x"), IsOk());
  EXPECT_THAT(CheckKernelLogs({.bias = true}, {.bias = std::nan("")}, "the file"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("the file")));
}

}  // namespace
}  // namespace pleat
