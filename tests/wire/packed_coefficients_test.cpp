#include "packed_coefficients.h"

#include <gtest/gtest.h>

#include "support/hostile_bytes.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Falling fast from half a meter, as those of a part do.
Eigen::VectorXf Coefficients(int count) {
  Eigen::VectorXf values = RandomMatrix(count, 1, 3).col(0).cast<float>();
  for (int i = 0; i < count; ++i) {
    values[i] *= .45f * std::pow(static_cast<float>(i % 70 + 1), -1.7f);
  }
  return values;
}

TEST(PackedCoefficientsTest, ComeBackWithinHalfAStepInFewBytes) {
  for (const int count : {0, 1, 257, 1000, 4096}) {
    const Eigen::VectorXf values = Coefficients(count);
    const std::string packed = PackCoefficients(values);
    PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXf back, UnpackCoefficients(packed, 4096));
    ASSERT_EQ(back.size(), count);
    if (count == 0) continue;
    EXPECT_LE((back - values).cwiseAbs().maxCoeff(), .501f * kCoefficientStep_m);
    // What is rounded stays, so passing it on costs nothing more.
    EXPECT_EQ(PackCoefficients(back), packed);
    if (count == 1000) {
      EXPECT_LT(packed.size(), 750u);
    }
  }
}

TEST(PackedCoefficientsTest, LargeOnesAreExactOrClamped) {
  const Eigen::Vector3f values(1000, -1000, 1e30f);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXf back,
                             UnpackCoefficients(PackCoefficients(values), 3));
  EXPECT_LT((back.head<2>() - values.head<2>()).norm(), 1e-3f);
  EXPECT_TRUE(std::isfinite(back[2]));
}

TEST(PackedCoefficientsTest, RefusesMoreThanTheLimitAndDamage) {
  const std::string packed = PackCoefficients(Coefficients(300));
  EXPECT_THAT(UnpackCoefficients(packed, 300), IsOk());
  EXPECT_THAT(UnpackCoefficients(packed, 299),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("more than 299")));
  // A megabyte of zeros in a kilobyte.
  EXPECT_THAT(UnpackCoefficients(PackCoefficients(Eigen::VectorXf::Zero(1 << 20)), 4096),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("more than 4096")));
  ForEachTruncation(
      packed, [](const std::string& cut) { EXPECT_FALSE(UnpackCoefficients(cut, 300).ok()); });
  EXPECT_FALSE(UnpackCoefficients("no zlib", 300).ok());
}

}  // namespace
}  // namespace pleat
