#include "pleat/formats/checkpoint_file.h"

#include <gtest/gtest.h>

#include <string>

#include "model_builder.h"
#include "pleat/formats/model_file.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::_;
using testing::HasSubstr;

// A checkpoint with the first `num_stages` of rig, fit, validate and learn.
CheckpointFile SmallCheckpoint(int num_stages) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  CheckpointFile file{.job_id = "job-7", .inputs = "learner=gp\nsequence=abc\n", .checkpoint = {}};
  TrainingCheckpoint& checkpoint = file.checkpoint;
  checkpoint.rigging = {.rig = model->rig(),
                        .rest_frame = 2,
                        .yaw_degrees = 1. / 3,
                        .residual = .015,
                        .warnings = {"the arms hang", ""},
                        .locked_joints = {0, 2}};
  if (num_stages >= 2) {
    PoseTrack::Parts parts{.fps = 29.97, .poses = {}, .clip_starts = {0, 2}};
    for (int t = 0; t < 3; ++t) {
      Pose pose = Pose::Rest(model->skeleton());
      pose.root_position << t / 3., .1, -1e-300;
      pose.rotations[1] = Eigen::AngleAxisd(.1 * t, Eigen::Vector3d(1, 2, 3).normalized());
      parts.poses.push_back(pose);
    }
    checkpoint.fit = {.track = PoseTrack::Create(std::move(parts)).value(),
                      .jitter_rad = .1,
                      .unsmoothed_jitter_rad = .2,
                      .unsmoothed_rms_m = .3};
  }
  if (num_stages >= 3) {
    checkpoint.choice = {
        .learner = LearnerChoice::kGp,
        .validation = {.num_held_out_frames = 4, .mean_percent = {{"gp", .1}, {"regional", .7}}}};
  }
  if (num_stages >= 4) {
    checkpoint.detail_model = std::make_shared<const DetailModel>(model->detail_model());
  }
  return file;
}

class CheckpointFileTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Stages, CheckpointFileTest, testing::Values(1, 2, 3, 4));

TEST_P(CheckpointFileTest, EverythingRoundTripsBitByBit) {
  const CheckpointFile file = SmallCheckpoint(GetParam());
  const std::string bytes = EncodeCheckpoint(file);
  PLEAT_ASSERT_OK_AND_ASSIGN(const CheckpointFile read, DecodeCheckpoint(bytes));
  EXPECT_EQ(EncodeCheckpoint(read), bytes);
  EXPECT_EQ(read.job_id, "job-7");
  EXPECT_EQ(read.inputs, file.inputs);
  const TrainingCheckpoint::Rigging& rigging = *read.checkpoint.rigging;
  EXPECT_EQ(rigging.rig.rest_positions, file.checkpoint.rigging->rig.rest_positions);
  EXPECT_EQ(rigging.rest_frame, 2);
  EXPECT_EQ(rigging.yaw_degrees, 1. / 3);
  EXPECT_EQ(rigging.warnings, file.checkpoint.rigging->warnings);
  EXPECT_EQ(rigging.locked_joints, (std::vector<int>{0, 2}));
  EXPECT_EQ(read.checkpoint.fit.has_value(), GetParam() >= 2);
  EXPECT_EQ(read.checkpoint.choice.has_value(), GetParam() >= 3);
  EXPECT_EQ(read.checkpoint.detail_model != nullptr, GetParam() >= 4);
  if (!read.checkpoint.fit) return;
  const PoseTrack &track = read.checkpoint.fit->track, &truth = file.checkpoint.fit->track;
  EXPECT_EQ(track.clip_starts(), truth.clip_starts());
  EXPECT_EQ(track.pose(2).rotations[1].coeffs(), truth.pose(2).rotations[1].coeffs());
  EXPECT_EQ(track.pose(2).root_position, truth.pose(2).root_position);
}

TEST_P(CheckpointFileTest, NoTruncationAndNoDamageIsBelieved) {
  const std::string bytes = EncodeCheckpoint(SmallCheckpoint(GetParam()));
  ForEachTruncation(bytes, [](const std::string& cut) {
    EXPECT_FALSE(DecodeCheckpoint(cut).ok()) << cut.size();
    EXPECT_FALSE(DecodeCheckpoint(Reseal(cut)).ok()) << cut.size();
  });
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  EXPECT_THAT(DecodeCheckpoint(damaged), HasStatus(absl::StatusCode::kDataLoss, _));
}

// Whoever can compute a checksum can write anything.
TEST_P(CheckpointFileTest, ResealedDamageIsRefusedOrReadsBackToTheSame) {
  const std::string bytes = EncodeCheckpoint(SmallCheckpoint(GetParam()));
  MeshLimits limits;
  limits.max_unfolded_bytes = 1 << 20;
  ForEachCorruption(bytes.substr(0, bytes.size() - 32), [&](const std::string& damaged) {
    const auto file = DecodeCheckpoint(Reseal(damaged + std::string(32, '\0')), limits);
    if (!file.ok()) return;
    const std::string written = EncodeCheckpoint(*file);
    const auto again = DecodeCheckpoint(written, limits);
    ASSERT_THAT(again, IsOk());
    EXPECT_EQ(EncodeCheckpoint(*again), written);
  });
}

TEST(CheckpointFile, OtherFilesAndCountsBeyondTheBytesAreRefused) {
  EXPECT_FALSE(DecodeCheckpoint("").ok());
  EXPECT_FALSE(DecodeCheckpoint(EncodeModel(*SmallModelBuilder(Learner::kGp).Build())).ok());
  const std::string bytes = EncodeCheckpoint(SmallCheckpoint(1));
  MeshLimits limits;
  limits.max_vertices = 2;
  EXPECT_THAT(DecodeCheckpoint(bytes, limits),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("vertices")));
  std::string longer = bytes;
  longer.insert(bytes.size() - 32, "x");
  EXPECT_THAT(DecodeCheckpoint(Reseal(longer)),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("too many")));
}

TEST(CheckpointFile, ARigWithoutVerticesIsRefused) {
  CheckpointFile file = SmallCheckpoint(1);
  file.checkpoint.rigging->rig =
      Rig{.skeleton = file.checkpoint.rigging->rig.skeleton, .weights = {}, .rest_positions = {}};
  file.checkpoint.rigging->warnings.clear();
  file.checkpoint.rigging->locked_joints.clear();
  std::string bytes = EncodeCheckpoint(file);
  // A count of influences that is allowed, before a flag, a frame, two numbers and two empty lists.
  bytes[bytes.size() - 32 - (4 + 4 + 4 + 8 + 8 + 4 + 4)] = 4;
  EXPECT_THAT(DecodeCheckpoint(Reseal(bytes)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("without vertices")));
}

}  // namespace
}  // namespace pleat
