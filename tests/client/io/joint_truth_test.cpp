#include "cli/io/joint_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/base/file.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kTwoJoints[] =
    R"({"frame": 3, "joints": [{"name": "hips", "position_m": [1, 2, 3]},
                               {"name": "tail", "position_m": [0, 0, 0], "parent": 0}]})";

TEST(JointTruth, ReadsNamesPositionsAndFrame) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointTruth truth, DecodeJointTruth(kTwoJoints));
  EXPECT_EQ(truth.frame, 3);
  EXPECT_THAT(truth.names, ElementsAre("hips", "tail"));
  EXPECT_EQ(truth.positions.col(0), Eigen::Vector3d(1, 2, 3));
}

TEST(JointTruth, ComparesTheJointsThatBothHave) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointTruth truth, DecodeJointTruth(kTwoJoints));
  Eigen::Matrix3Xd joints = Eigen::Matrix3Xd::Zero(3, kNumHumanJoints);
  joints.col(kHips) << 1, 2, 3.5;
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointErrors errors,
                             CompareJoints(truth, HumanTemplate(), joints));
  EXPECT_THAT(errors.names, ElementsAre("hips"));
  EXPECT_DOUBLE_EQ(errors.mean_m, .5);
  EXPECT_DOUBLE_EQ(errors.max_m, .5);
  JointTruth strange = truth;
  strange.names = {"tail", "wing"};
  EXPECT_THAT(CompareJoints(strange, HumanTemplate(), joints),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("name")));
}

TEST(JointTruth, SaysWhatIsWrong) {
  const auto expect_fault = [](const char* text, const char* word) {
    EXPECT_THAT(DecodeJointTruth(text),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(word)))
        << text;
  };
  expect_fault("", "JSON");
  expect_fault("[1", "JSON");
  expect_fault("[]", "JSON");
  expect_fault("{}", "'joints'");
  expect_fault(R"({"joints": []})", "'joints'");
  expect_fault(R"({"joints": [4]})", "no name");
  expect_fault(R"({"joints": [{"name": 4}]})", "no name");
  expect_fault(R"({"joints": [{"name": "a"}]})", "position_m");
  expect_fault(R"({"joints": [{"name": "a", "position_m": [1, 2]}]})", "position_m");
  expect_fault(R"({"joints": [{"name": "a", "position_m": [1, 2, "x"]}]})", "finite");
  expect_fault(R"({"joints": [{"name": "a", "position_m": [1, 2, 3]},
                              {"name": "a", "position_m": [1, 2, 3]}]})",
               "twice");
  expect_fault(R"({"frame": -1, "joints": [{"name": "a", "position_m": [1, 2, 3]}]})", "frame");
}

TEST(JointTruth, IsFoundBesideTheInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(FindJointTruth(folder.File("walk.pc2")), "");
  ASSERT_THAT(WriteFile(folder.File("truth.json"), kTwoJoints), IsOk());
  EXPECT_EQ(FindJointTruth(folder.File("walk.pc2")), folder.File("truth.json"));
  ASSERT_THAT(WriteFile(folder.File("walk_truth.json"), kTwoJoints), IsOk());
  EXPECT_EQ(FindJointTruth(folder.File("walk.pc2")), folder.File("walk_truth.json"));
  EXPECT_THAT(ReadJointTruth(folder.File("walk_truth.json")), IsOk());
}

}  // namespace
}  // namespace pleat
