// A character that tests of the C interface share: its model on both sides, and poses for it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pleat.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "support/fake_training.h"

namespace pleat {

template <typename Handle, void (*destroy)(Handle*)>
struct Destroyer {
  void operator()(Handle* handle) const { destroy(handle); }
};
using CModel = std::unique_ptr<pleat_model, Destroyer<pleat_model, pleat_model_destroy>>;
using CMotion = std::unique_ptr<pleat_motion, Destroyer<pleat_motion, pleat_motion_destroy>>;
using CEvaluator =
    std::unique_ptr<pleat_evaluator, Destroyer<pleat_evaluator, pleat_evaluator_destroy>>;

inline CModel ReadCModel(const std::string& bytes) {
  pleat_model* model = nullptr;
  pleat_error error;
  EXPECT_EQ(pleat_model_create(bytes.data(), bytes.size(), nullptr, &model, &error), PLEAT_OK)
      << error.message;
  return CModel(model);
}

// A pose of ours as a caller of the C interface has it.
struct CPose {
  explicit CPose(const Pose& pose) {
    for (const Eigen::Quaterniond& q : pose.rotations) {
      rotations.insert(rotations.end(), {q.x(), q.y(), q.z(), q.w()});
    }
    shown = {
        .root_position = {pose.root_position.x(), pose.root_position.y(), pose.root_position.z()},
        .rotations = rotations.data(),
        .num_joints = pose.rotations.size()};
  }
  CPose(CPose&&) = default;  // the numbers stay where they are

  std::vector<double> rotations;
  pleat_pose shown;
};

class CCharacterTest : public ::testing::Test {
 protected:
  int num_vertices() const { return character_->num_vertices(); }

  // The pose of frame t, then those before it.
  std::vector<const Pose*> History(int t, int count) const {
    std::vector<const Pose*> poses;
    for (int h = 0; h < count; ++h) poses.push_back(&track_.pose(t - h));
    return poses;
  }
  std::vector<pleat_pose> CHistory(int t, int count) const {
    std::vector<pleat_pose> poses;
    for (int h = 0; h < count; ++h) poses.push_back(c_poses_[t - h].shown);
    return poses;
  }
  pleat_rows RowsOfFrame(Eigen::Matrix3Xf* frame) const {
    frame->setConstant(3, num_vertices(), -77);
    return {.data = frame->data(), .stride = 0, .num_bytes = 12u * num_vertices()};
  }
  pleat_query Query(const std::vector<pleat_pose>& poses, Eigen::Matrix3Xf* frame) const {
    pleat_query query{};
    query.struct_size = sizeof(query);
    query.poses = poses.data();
    query.num_poses = poses.size();
    query.positions = RowsOfFrame(frame);
    query.code = -1;
    return query;
  }
  void ExpectFrame(const std::vector<const Pose*>& poses, const Eigen::Matrix3Xf& frame,
                   double confidence) {
    EvaluatedFrame expected;
    ASSERT_TRUE(truth_.Evaluate(poses, {}, &expected).ok());
    EXPECT_EQ(frame, expected.positions);
    EXPECT_EQ(confidence, expected.confidence);
  }

  const std::shared_ptr<const CharacterModel> character_ =
      MakeFakeModel(MakeSwayingTube(2), {.history = 3});
  const std::string bytes_ = EncodeModel(*character_);
  const PoseTrack track_ = MakeMotion(character_->skeleton(), 40);
  const std::vector<CPose> c_poses_ = [this] {
    std::vector<CPose> poses;
    for (const Pose& pose : track_.poses()) poses.emplace_back(pose);
    return poses;
  }();
  PoseEvaluator truth_{character_};
  CModel model_ = ReadCModel(bytes_);
  CEvaluator evaluator_ = [this] {
    pleat_evaluator* evaluator = nullptr;
    EXPECT_EQ(pleat_evaluator_create(model_.get(), &evaluator, nullptr), PLEAT_OK);
    return CEvaluator(evaluator);
  }();
  pleat_error error_{};
};

}  // namespace pleat
