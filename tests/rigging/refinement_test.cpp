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

TEST(RefinementTest, TheTemplateInItsOwnMedialSurfaceStays) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  const Eigen::Matrix3Xd refined = RefineEmbedding(truth, truth, SamplesOnBones(truth));
  EXPECT_LT((refined - truth).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(RefinementTest, PullsDisturbedJointsBackToTheMiddleOfTheLimbs) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Random random(6);
  Eigen::Matrix3Xd start = truth;
  for (int k = 0; k < start.size(); ++k) start.data()[k] += random.Uniform(-.012, .012);
  const Eigen::Matrix3Xd refined = RefineEmbedding(start, truth, SamplesOnBones(truth));
  const double before = (start - truth).colwise().norm().mean();
  const double after = (refined - truth).colwise().norm().mean();
  EXPECT_LT(after, .5 * before);
}

TEST(RefinementTest, CoincidentJointsStayFinite) {
  const Eigen::Matrix3Xd truth = .9 * HumanTemplate().RestPositions();
  Eigen::Matrix3Xd start = truth;
  start.col(kLeftUpperLeg) = start.col(kHips);
  EXPECT_TRUE(RefineEmbedding(start, truth, SamplesOnBones(truth)).allFinite());
}

}  // namespace
}  // namespace pleat
