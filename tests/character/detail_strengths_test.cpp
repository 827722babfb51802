#include "pleat/character/detail_strengths.h"

#include <gtest/gtest.h>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

class DetailStrengthsTest : public testing::Test {
 protected:
  Eigen::Matrix3Xf Show(const DetailStrengths& strengths) const {
    PoseEvaluator evaluator(model_);
    EXPECT_THAT(evaluator.SetDetailStrengths(strengths), IsOk());
    EvaluatedFrame frame;
    EXPECT_THAT(evaluator.Evaluate({&pose_}, {}, &frame), IsOk());
    return frame.positions;
  }
  Eigen::Matrix3Xf Skinned() const {
    PoseEvaluator evaluator(model_);
    EvaluatedFrame frame;
    EXPECT_THAT(evaluator.EvaluateSkinned(pose_, {}, &frame), IsOk());
    return frame.positions;
  }

  const std::shared_ptr<const CharacterModel> model_ =
      MakeFakeModel(MakeSwayingTube(4), TrainOptions());
  const Pose pose_ = Pose::Rest(model_->skeleton());
};

TEST_F(DetailStrengthsTest, OneChangesNoBitAndZeroIsSkinnedOnly) {
  const Eigen::Matrix3Xf plain = Show({});
  EXPECT_EQ(Show({.joints = {1, 1, 1}}), plain);
  EXPECT_EQ(Show({.joints = {}, .vertices = std::vector<float>(96, 1.f)}), plain);
  EXPECT_LT((Show({.joints = {1, 0, 0}}) - Skinned()).cwiseAbs().maxCoeff(), 1e-6f);
  EXPECT_GT((plain - Skinned()).cwiseAbs().maxCoeff(), 1e-4f);
}

// Of vertex v: the mean of the factors of its bones by its weights, times its
// own.
TEST_F(DetailStrengthsTest, EachVertexHasTheMeanOfItsBonesTimesItsOwn) {
  std::vector<float> painted(96);
  for (size_t v = 0; v < 96; ++v) painted[v] = static_cast<float>(v % 5) / 2;
  const Eigen::Matrix3Xf plain = Show({}), skinned = Skinned();
  const Eigen::Matrix3Xf shown = Show({.joints = {1, .5, 2}, .vertices = painted});
  const Eigen::MatrixXd weights = model_->rig().weights.ToDense();
  for (int v = 0; v < 96; ++v) {
    const double factor =
        painted[static_cast<size_t>(v)] * (.5 * weights(v, 1) + 2 * weights(v, 2));
    const Eigen::Vector3f expected =
        skinned.col(v) + static_cast<float>(factor) * (plain.col(v) - skinned.col(v));
    EXPECT_LT((shown.col(v) - expected).norm(), 1e-6f) << v;
  }
}

TEST_F(DetailStrengthsTest, QueriesOfABatchFollowTheirOwnEvaluators) {
  PoseEvaluator strong(model_), plain(model_);
  ASSERT_THAT(strong.SetDetailStrengths({.joints = {1, 2, 2}}), IsOk());
  const std::vector<const Pose*> poses = {&pose_};
  EvaluatedFrame a, b;
  std::vector<PoseQuery> queries(2);
  queries[0] = {.poses = &poses, .frame = &a, .scratch_of = &strong};
  queries[1] = {.poses = &poses, .frame = &b, .scratch_of = &plain};
  plain.EvaluateBatch(queries);
  EXPECT_EQ(a.positions, Show({.joints = {1, 2, 2}}));
  EXPECT_EQ(b.positions, Show({}));
  // Parameters carry none: who shows them has its own.
  FrameParameters parameters;
  ASSERT_THAT(strong.Predict(poses, false, &parameters), IsOk());
  EvaluatedFrame shown;
  ASSERT_THAT(strong.Show(parameters, {}, &shown), IsOk());
  EXPECT_LT((shown.positions - a.positions).cwiseAbs().maxCoeff(), 1e-5f);
  ASSERT_THAT(strong.SetDetailStrengths({}), IsOk());
  ASSERT_THAT(strong.Evaluate(poses, {}, &shown), IsOk());
  EXPECT_EQ(shown.positions, b.positions);
}

TEST_F(DetailStrengthsTest, WrongCountsAndFactorsAreNamed) {
  PoseEvaluator evaluator(model_);
  for (const auto& [strengths, reason] :
       {std::pair(DetailStrengths{.joints = {1, 1}}, "2 detail strengths"),
        std::pair(DetailStrengths{.joints = {1, 1, 2.5}}, "2.5 of joint 2"),
        std::pair(DetailStrengths{.joints = {1, -.1, 1}}, "-0.1 of joint 1"),
        std::pair(DetailStrengths{.joints = {1, NAN, 1}}, "of joint 1"),
        std::pair(DetailStrengths{.joints = {}, .vertices = {1.f}}, "1 detail strengths"),
        std::pair(DetailStrengths{.joints = {}, .vertices = std::vector<float>(96, 3.f)},
                  "3 of vertex 0")}) {
    EXPECT_THAT(evaluator.SetDetailStrengths(strengths), HasStatus(kInvalid, HasSubstr(reason)));
  }
}

}  // namespace
}  // namespace pleat
