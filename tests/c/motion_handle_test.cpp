#include <gmock/gmock.h>

#include <cmath>

#include "c_character.h"
#include "support/allocation_counter.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class MotionHandleTest : public CCharacterTest {
 protected:
  CMotion motion_ = [this] {
    pleat_motion* motion = nullptr;
    EXPECT_EQ(pleat_motion_create(model_.get(), &motion, nullptr), PLEAT_OK);
    return CMotion(motion);
  }();
};

// At the frame rate of the training, a motion gives the very frames that a clip gives.
TEST_F(MotionHandleTest, ALiveMotionShowsTheFramesOfAClip) {
  std::vector<Eigen::Matrix3Xf> clip;
  ASSERT_TRUE(truth_
                  .EvaluateClip(track_, {},
                                [&](int, const EvaluatedFrame& frame) {
                                  clip.push_back(frame.positions);
                                  return absl::OkStatus();
                                })
                  .ok());
  const pleat_pose* poses = nullptr;
  size_t num_poses = 0;
  Eigen::Matrix3Xf frame;
  for (int t = 0; t < track_.num_frames(); ++t) {
    ASSERT_EQ(pleat_motion_push(motion_.get(), 10 + t / 25.0, &c_poses_[t].shown, &error_),
              PLEAT_OK)
        << error_.message;
    ASSERT_EQ(pleat_motion_poses(motion_.get(), &poses, &num_poses, &error_), PLEAT_OK);
    ASSERT_EQ(num_poses, 3u);
    if (t < 2) continue;  // a clip knows the future, from which it continues its beginning
    pleat_query query = Query({}, &frame);
    query.poses = poses;
    query.num_poses = num_poses;
    ASSERT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
    EXPECT_EQ(frame, clip[t]) << t;
  }
}

TEST_F(MotionHandleTest, ARestartForgets) {
  const pleat_pose* poses = nullptr;
  size_t num_poses = 0;
  EXPECT_EQ(pleat_motion_poses(motion_.get(), &poses, &num_poses, &error_),
            PLEAT_FAILED_PRECONDITION);
  EXPECT_THAT(error_.message, HasSubstr("push one first"));
  ASSERT_EQ(pleat_motion_push(motion_.get(), 1, &c_poses_[0].shown, &error_), PLEAT_OK);
  ASSERT_EQ(pleat_motion_push(motion_.get(), 2, &c_poses_[9].shown, &error_), PLEAT_OK);
  pleat_motion_restart(motion_.get());
  EXPECT_EQ(pleat_motion_poses(motion_.get(), &poses, &num_poses, &error_),
            PLEAT_FAILED_PRECONDITION);
  ASSERT_EQ(pleat_motion_push(motion_.get(), 0, &c_poses_[5].shown, &error_), PLEAT_OK);
  ASSERT_EQ(pleat_motion_poses(motion_.get(), &poses, &num_poses, &error_), PLEAT_OK);
  for (size_t h = 0; h < num_poses; ++h) {
    EXPECT_TRUE(
        std::equal(c_poses_[5].rotations.begin(), c_poses_[5].rotations.end(), poses[h].rotations));
  }
}

TEST_F(MotionHandleTest, BadPosesAndTimesAreErrorsAndLeaveNoTrace) {
  ASSERT_EQ(pleat_motion_push(motion_.get(), 1, &c_poses_[0].shown, &error_), PLEAT_OK);
  const auto refused = [&](double seconds, const pleat_pose* pose, const char* word) {
    EXPECT_EQ(pleat_motion_push(motion_.get(), seconds, pose, &error_), PLEAT_INVALID_ARGUMENT);
    EXPECT_THAT(error_.message, HasSubstr(word));
  };
  refused(1, &c_poses_[1].shown, "restart the motion");
  refused(NAN, &c_poses_[1].shown, "not finite");
  refused(2, nullptr, "pose is NULL");
  pleat_pose bad = c_poses_[1].shown;
  bad.num_joints = 1000000;
  refused(2, &bad, "1000000 joints");
  bad = c_poses_[1].shown;
  bad.rotations = nullptr;
  refused(2, &bad, "NULL");
  bad = c_poses_[1].shown;
  bad.root_position[1] = INFINITY;
  refused(2, &bad, "root position");
  EXPECT_EQ(pleat_motion_push(nullptr, 2, &bad, &error_), PLEAT_INVALID_ARGUMENT);
  const pleat_pose* poses = nullptr;
  size_t num_poses = 0;
  ASSERT_EQ(pleat_motion_poses(motion_.get(), &poses, &num_poses, &error_), PLEAT_OK);
  EXPECT_EQ(poses[0].root_position[1], c_poses_[0].shown.root_position[1]);
  EXPECT_EQ(pleat_motion_poses(motion_.get(), nullptr, &num_poses, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_motion_poses(motion_.get(), &poses, nullptr, &error_), PLEAT_INVALID_ARGUMENT);
  pleat_motion* motion = motion_.get();
  EXPECT_EQ(pleat_motion_create(nullptr, &motion, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(motion, nullptr);
}

// The motion of a model that is gone goes on, and takes no memory.
TEST_F(MotionHandleTest, OutlivesItsModelAndAllocatesNothing) {
  model_.reset();
  const pleat_pose* poses = nullptr;
  size_t num_poses = 0;
  const long before = NumAllocations();
  pleat_code worst = PLEAT_OK;
  for (int i = 0; i < 200; ++i) {
    worst = std::max(worst,
                     pleat_motion_push(motion_.get(), .001 * i, &c_poses_[i % 40].shown, nullptr));
    worst = std::max(worst, pleat_motion_poses(motion_.get(), &poses, &num_poses, nullptr));
  }
  EXPECT_EQ(NumAllocations() - before, 0);
  EXPECT_EQ(worst, PLEAT_OK);
}

}  // namespace
}  // namespace pleat
