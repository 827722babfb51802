#include "pleat/rigging/refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

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

// A start that is off, with the same medial surface for all of the following.
struct Disturbed {
  Disturbed() {
    Random random(6);
    for (double& x : start.reshaped()) x += random.Uniform(-.012, .012);
  }
  Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Eigen::Matrix3Xd start = truth;
};

// Where the body stands and how it is turned must not matter: all energies are relative.
TEST(RefinementTest, ATurnedAndMovedBodyIsRefinedAlike) {
  const Disturbed body;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(.3, 1, -.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(.2, -.4, .1);
  const auto moved = [&](const Eigen::Matrix3Xd& joints) {
    return Eigen::Matrix3Xd((turn * joints).colwise() + shift);
  };
  const Eigen::Matrix3Xd here = RefineEmbedding(body.start, body.truth, SamplesOnBones(body.truth));
  const Eigen::Matrix3Xd there =
      RefineEmbedding(moved(body.start), moved(body.truth), SamplesOnBones(moved(body.truth)));
  EXPECT_LT((there - moved(here)).colwise().norm().maxCoeff(), 2e-3);
}

TEST(RefinementTest, AMirroredBodyIsRefinedMirrored) {
  const Disturbed body;
  const auto mirrored = [](const Eigen::Matrix3Xd& joints) {
    Eigen::Matrix3Xd result(3, kNumHumanJoints);
    for (int j = 0; j < kNumHumanJoints; ++j) {
      result.col(j) = Eigen::Vector3d(-1, 1, 1).cwiseProduct(joints.col(HumanMirror()[j]));
    }
    return result;
  };
  const Eigen::Matrix3Xd here = RefineEmbedding(body.start, body.truth, SamplesOnBones(body.truth));
  const Eigen::Matrix3Xd there = RefineEmbedding(mirrored(body.start), mirrored(body.truth),
                                                 SamplesOnBones(mirrored(body.truth)));
  EXPECT_LT((there - mirrored(here)).colwise().norm().maxCoeff(), 2e-3);
}

TEST(RefinementTest, NoIterationsAndNoSurfaceLeaveWhatTheyMust) {
  const Disturbed body;
  EXPECT_EQ(
      RefineEmbedding(body.start, body.truth, SamplesOnBones(body.truth), {.max_iterations = 0}),
      body.start);
  // Without a surface only the shape of the template is left to follow.
  const Eigen::Matrix3Xd refined = RefineEmbedding(body.truth, body.truth, {}, {.proportions = 0});
  EXPECT_LT((refined - body.truth).colwise().norm().maxCoeff(), .02);
}

TEST(RefinementTest, CoincidentJointsStayFinite) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Eigen::Matrix3Xd start = truth;
  start.col(kLeftUpperLeg) = start.col(kHips);
  EXPECT_TRUE(RefineEmbedding(start, truth, SamplesOnBones(truth)).allFinite());
}

}  // namespace
}  // namespace pleat
