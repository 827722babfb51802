#include "pleat/rigging/refinement.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Medial samples on the bones of `joints`.
std::vector<MedialSample> SamplesOnBones(const Eigen::Matrix3Xd& joints) {
  std::vector<MedialSample> samples;
  for (int b = 1; b < kNumHumanJoints; ++b) {
    for (int k = 0; k <= 40; ++k) {
      samples.push_back({joints.col(HumanTemplate().parent(b)) +
                             k / 40.0 * (joints.col(b) - joints.col(HumanTemplate().parent(b))),
                         .02});
    }
  }
  return samples;
}

// Without the proportions of people, which are not quite the template's.
constexpr RefinementOptions kShapeAlone = {.proportions = 0};

TEST(RefinementTest, TheTemplateInItsOwnMedialSurfaceStays) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  const Eigen::Matrix3Xd refined =
      RefineEmbedding(truth, truth, SamplesOnBones(truth), kShapeAlone);
  EXPECT_LT((refined - truth).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(RefinementTest, PullsDisturbedJointsBackToTheMiddleOfTheLimbs) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Random random(6);
  Eigen::Matrix3Xd start = truth;
  for (int k = 0; k < start.size(); ++k) start.data()[k] += random.Uniform(-.012, .012);
  const Eigen::Matrix3Xd refined =
      RefineEmbedding(start, truth, SamplesOnBones(truth), kShapeAlone);
  const double before = (start - truth).colwise().norm().mean();
  const double after = (refined - truth).colwise().norm().mean();
  EXPECT_LT(after, .5 * before);
}

TEST(RefinementTest, KneesSlideAlongTheLegToTheProportionsOfPeople) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Eigen::Matrix3Xd start = truth;
  for (const int knee : {kLeftLowerLeg, kRightLowerLeg}) {
    start.col(knee) += .3 * (truth.col(knee - 1) - truth.col(knee));  // .2 of the thigh too high
  }
  const Eigen::Matrix3Xd refined = RefineEmbedding(start, truth, SamplesOnBones(truth));
  const auto length = [&](int a, int b) { return (refined.col(a) - refined.col(b)).norm(); };
  for (const int hip : {kLeftUpperLeg, kRightUpperLeg}) {
    const double thigh = length(hip, hip + 1), shin = length(hip + 1, hip + 2);
    EXPECT_NEAR(thigh / (thigh + shin), .499, .01);
    const double trunk = (refined.col(kLeftUpperArm) + refined.col(kRightUpperArm) -
                          refined.col(kLeftUpperLeg) - refined.col(kRightUpperLeg))
                             .norm() /
                         2;
    EXPECT_NEAR((thigh + shin) / trunk, 1.705, .06);
    // Still in the middle of the leg.
    const Eigen::Vector3d along = (truth.col(hip + 2) - truth.col(hip + 1)).normalized();
    const Eigen::Vector3d aside = refined.col(hip + 1) - truth.col(hip + 1);
    EXPECT_LT((aside - aside.dot(along) * along).norm(), .01);
  }
}

TEST(RefinementTest, TheMiddleOfASkirtSaysLittle) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  std::vector<MedialSample> samples = SamplesOnBones(truth);
  // Around the thighs the medial surface is that of a bell: its axis, deep inside.
  const double hip_y = truth(1, kHips), knee_y = truth(1, kLeftLowerLeg);
  std::erase_if(samples, [&](const MedialSample& sample) {
    return sample.position.y() < hip_y && sample.position.y() > knee_y;
  });
  for (double y = knee_y; y < hip_y; y += .005) samples.push_back({{0, y, 0}, .12});
  const auto drift = [&](double limb_radius) {
    const RefinementOptions options{.limb_radius = limb_radius, .proportions = 0};
    const Eigen::Matrix3Xd refined = RefineEmbedding(truth, truth, samples, options);
    return (refined - truth).col(kLeftLowerLeg).norm() +
           (refined - truth).col(kLeftUpperLeg).norm();
  };
  EXPECT_LT(drift(.03), .5 * drift(1));
}

TEST(RefinementTest, CoincidentJointsStayFinite) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Eigen::Matrix3Xd start = truth;
  start.col(kLeftUpperLeg) = start.col(kHips);
  EXPECT_TRUE(RefineEmbedding(start, truth, SamplesOnBones(truth)).allFinite());
}

}  // namespace
}  // namespace pleat
