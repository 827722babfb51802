#include "cli/io/rig_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/exit_code.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// The figure standing, and two centimeters higher in every later frame.
MeshSequence RisingFigure(const CapsuleFigure& figure, int num_frames) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    frames.push_back(figure.mesh.positions.cast<float>());
    frames.back().row(1).array() += .02f * static_cast<float>(t);
  }
  return MeshSequence::Create(MakeTopology(figure.mesh), std::move(frames), {.name = "figure"})
      .value();
}

TEST(RigMeasurementTest, AFigureIsRiggedAndMeasuredAgainstItsOwnJoints) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  JointTruth truth;
  truth.frame = 0;
  for (int j = 0; j < kNumHumanJoints; ++j) truth.names.push_back(HumanTemplate().joint(j).name);
  truth.positions = figure.joints;
  const MeshSequence sequence = RisingFigure(figure, 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigMeasurement measured,
                             MeasureRig("figure.pseq", sequence, &truth, {}));
  ASSERT_THAT(measured.status, IsOk());
  ASSERT_TRUE(measured.rig.has_value());
  EXPECT_EQ(measured.num_frames, 3);
  EXPECT_NEAR(measured.height_m, 1.7, .1);
  EXPECT_LT(measured.joint_errors->mean_m, .05);
  // It only rises: skinning follows exactly, with either rig.
  EXPECT_LT(*measured.fit_rms_percent, .05);
  EXPECT_LT(*measured.refined_rms_percent, .05);
  EXPECT_LT(*measured.refined_joint_mean_m, .06);

  const nlohmann::ordered_json json = RigMeasurementJson(measured);
  EXPECT_EQ(json["input"], "figure.pseq");
  EXPECT_EQ(json["is_refused"], false);
  EXPECT_EQ(json["joints"].size(), 18u);
  EXPECT_EQ(json["joint_error"]["joints_m"].size(), 18u);
  EXPECT_EQ(json["fit"]["rms_percent"], *measured.fit_rms_percent);
  EXPECT_FALSE(json.contains("message"));
}

TEST(RigMeasurementTest, ARefusalIsARowWithItsReason) {
  const MeshSequence horse = MakeStillSequence(MakeCapsuleQuadruped(.05));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigMeasurement measured,
                             MeasureRig("horse.pseq", horse, nullptr, {}));
  EXPECT_THAT(measured.status, HasStatus(absl::StatusCode::kFailedPrecondition, testing::_));
  EXPECT_FALSE(measured.rig.has_value());
  EXPECT_FALSE(measured.fit_rms_percent.has_value());
  const nlohmann::ordered_json json = RigMeasurementJson(measured);
  EXPECT_EQ(json["is_refused"], true);
  EXPECT_EQ(json["message"], std::string(measured.status.message()));
  EXPECT_EQ(json["mesh_report"]["closed"], true);
  EXPECT_FALSE(json.contains("joints"));
}

TEST(RigMeasurementTest, FramesThatAreNotThereAreUsageErrors) {
  const MeshSequence horse = MakeStillSequence(MakeCapsuleQuadruped(.08));
  for (const int first_frame : {-1, 1, 100}) {
    RigMeasurementOptions options;
    options.first_frame = first_frame;
    const absl::Status status = MeasureRig("horse", horse, nullptr, options).status();
    EXPECT_TRUE(IsUsageError(status)) << first_frame;
    EXPECT_THAT(std::string(status.message()), HasSubstr("figure has 1 frames"));
  }
}

TEST(RigMeasurementTest, CancellationIsNoRow) {
  const MeshSequence horse = MakeStillSequence(MakeCapsuleQuadruped(.08));
  EXPECT_THAT(MeasureRig("horse", horse, nullptr, {}, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
