#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "c_character.h"
#include "pleat/character/joint_confidence.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ModelRigHandleTest : public CCharacterTest {
 protected:
  size_t num_vertex_values() const { return static_cast<size_t>(num_vertices()); }
};

TEST_F(ModelRigHandleTest, TheRestMeshIsTheRigs) {
  std::vector<float> positions(3 * num_vertex_values());
  ASSERT_EQ(
      pleat_model_copy_rest_positions(model_.get(), positions.data(), positions.size(), &error_),
      PLEAT_OK);
  const Eigen::Matrix3Xf expected = character_->rig().rest_positions.cast<float>();
  EXPECT_EQ(Eigen::Map<Eigen::Matrix3Xf>(positions.data(), 3, num_vertices()), expected);
  EXPECT_EQ(pleat_model_copy_rest_positions(model_.get(), positions.data(), positions.size() - 1,
                                            &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_model_copy_rest_positions(model_.get(), nullptr, positions.size(), &error_),
            PLEAT_INVALID_ARGUMENT);
}

TEST_F(ModelRigHandleTest, AllInfluencesAreTheSkin) {
  std::vector<uint32_t> bones(8 * num_vertex_values());
  std::vector<float> weights(bones.size());
  ASSERT_EQ(pleat_model_copy_influences(model_.get(), 8, bones.data(), weights.data(), bones.size(),
                                        &error_),
            PLEAT_OK);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_vertices(), 3);
  for (size_t i = 0; i < bones.size(); ++i) {
    dense(static_cast<Eigen::Index>(i / 8), bones[i]) += weights[i];
  }
  EXPECT_TRUE(dense.isApprox(character_->rig().weights.ToDense(), 1e-6));
}

TEST_F(ModelRigHandleTest, FewerInfluencesAreTheStrongestAndSumToOne) {
  std::vector<uint32_t> bones(num_vertex_values());
  std::vector<float> weights(bones.size());
  ASSERT_EQ(pleat_model_copy_influences(model_.get(), 1, bones.data(), weights.data(), bones.size(),
                                        &error_),
            PLEAT_OK);
  for (size_t v = 0; v < bones.size(); ++v) {
    EXPECT_EQ(bones[v], character_->rig().weights.influences()[v].bones[0]);
    EXPECT_EQ(weights[v], 1);
  }
  for (const uint32_t per_vertex : {0u, 9u}) {
    EXPECT_EQ(pleat_model_copy_influences(model_.get(), per_vertex, bones.data(), weights.data(),
                                          bones.size(), &error_),
              PLEAT_INVALID_ARGUMENT);
    EXPECT_THAT(error_.message, HasSubstr("1 to 8"));
  }
}

TEST_F(ModelRigHandleTest, TheRecordIsWhatTheTrainingWroteDown) {
  pleat_model_record record{};
  record.struct_size = sizeof(record);
  ASSERT_EQ(pleat_model_get_record(model_.get(), &record, &error_), PLEAT_OK);
  EXPECT_EQ(std::string(record.learner), "gp");
  EXPECT_EQ(record.diagonal_m, character_->record().diagonal_m);
  EXPECT_EQ(record.detailed.mean_percent, character_->record().reconstruction.mean_percent);
  ASSERT_EQ(record.num_warnings, 1u);
  EXPECT_EQ(std::string(pleat_model_warning(model_.get(), 0)), "made by a test");
  EXPECT_EQ(pleat_model_warning(model_.get(), 1), nullptr);
  record.struct_size = 4;
  EXPECT_EQ(pleat_model_get_record(model_.get(), &record, &error_), PLEAT_INVALID_ARGUMENT);
}

TEST_F(ModelRigHandleTest, JointConfidenceIsTheLibrarys) {
  std::vector<double> expected, found(3);
  ASSERT_TRUE(JointConfidence(*character_, History(20, 3), &expected).ok());
  const std::vector<pleat_pose> poses = CHistory(20, 3);
  ASSERT_EQ(
      pleat_joint_confidence(model_.get(), poses.data(), poses.size(), found.data(), 3, &error_),
      PLEAT_OK);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(
      pleat_joint_confidence(model_.get(), poses.data(), poses.size(), found.data(), 2, &error_),
      PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_joint_confidence(model_.get(), nullptr, 1, found.data(), 3, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_joint_confidence(nullptr, poses.data(), 1, found.data(), 3, &error_),
            PLEAT_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace pleat
