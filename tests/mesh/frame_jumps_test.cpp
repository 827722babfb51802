#include "pleat/mesh/frame_jumps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pleat/base/random.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Frames = std::vector<Eigen::Matrix3Xf>;

// A tube that sways, breathes and ripples; `speed` 1 is lively at 30 frames per second.
Frames MakeFrames(const MeshShape& shape, int num_frames, double speed) {
  Frames frames;
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xd frame = shape.positions;
    for (Eigen::Index v = 0; v < frame.cols(); ++v) {
      const double y = frame(1, v), phase = .3 * speed * t;
      frame(0, v) += .3 * y * std::sin(phase) + .02 * std::sin(20 * y + 3 * phase);
      frame(2, v) *= 1 + .1 * std::sin(phase + 5 * y);
    }
    frames.push_back(frame.cast<float>());
  }
  return frames;
}

MeshSequence Sequence(const MeshShape& shape, Frames frames) {
  return MeshSequence::Create(shape.topology, std::move(frames), {.name = "clip"}).value();
}

// Exchanges the positions of that share of the vertices, which lie all over the mesh.
Eigen::Matrix3Xf Shuffled(const Eigen::Matrix3Xf& frame, double share, uint64_t seed) {
  std::vector<int> chosen(static_cast<size_t>(frame.cols()));
  std::iota(chosen.begin(), chosen.end(), 0);
  Random random(seed);
  for (int i = static_cast<int>(chosen.size()) - 1; i > 0; --i) {
    std::swap(chosen[i], chosen[random.UniformInt(i + 1)]);
  }
  chosen.resize(static_cast<size_t>(share * static_cast<double>(chosen.size())));
  Eigen::Matrix3Xf result = frame;
  for (size_t i = 0; i < chosen.size(); ++i) {
    result.col(chosen[i]) = frame.col(chosen[(i + 1) % chosen.size()]);
  }
  return result;
}

class FrameJumpsTest : public testing::Test {
 protected:
  std::vector<FrameJump> Find(const Frames& frames) const {
    return FindFrameJumps(Sequence(tube_, frames));
  }
  const MeshShape tube_ = MakeTube(.2, 2, 24, 16);
};

TEST_F(FrameJumpsTest, MotionHasNoneHoweverLivelyAndWhateverTheLength) {
  for (const double speed : {0.0, 1.0, 4.0, 10.0}) {
    for (const int num_frames : {1, 2, 3, 5, 60}) {
      EXPECT_THAT(Find(MakeFrames(tube_, num_frames, speed)), IsEmpty()) << speed << num_frames;
    }
  }
}

TEST_F(FrameJumpsTest, AFrameOfAnotherSizeIsFoundWithItsFactor) {
  for (const double factor : {10.0, .01, 2.54, 1.5}) {
    for (const int t : {0, 1, 7, 19}) {
      Frames frames = MakeFrames(tube_, 20, 1);
      frames[t] *= static_cast<float>(factor);
      const std::vector<FrameJump> jumps = Find(frames);
      ASSERT_EQ(jumps.size(), 1u) << factor << " " << t;
      EXPECT_THAT(jumps[0].frames, ElementsAre(t));
      EXPECT_TRUE(jumps[0].is_scaled_only());
      EXPECT_NEAR(jumps[0].change.scale / factor, 1, .05);
    }
  }
}

TEST_F(FrameJumpsTest, TheLargerPartIsTheMotion) {
  Frames frames = MakeFrames(tube_, 20, 1);
  for (int t = 13; t < 20; ++t) frames[t] *= 100;
  const std::vector<FrameJump> jumps = Find(frames);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_THAT(jumps[0].frames, ElementsAre(13, 14, 15, 16, 17, 18, 19));
  for (int t = 4; t < 13; ++t) frames[t] *= 100;
  ASSERT_EQ(Find(frames).size(), 1u);
  EXPECT_THAT(Find(frames)[0].frames, ElementsAre(0, 1, 2, 3));
}

TEST_F(FrameJumpsTest, FramesThatJumpTheSameWayAreOneJump) {
  Frames frames = MakeFrames(tube_, 30, 1);
  for (const int t : {3, 9, 10, 25}) frames[t] *= 10;
  const std::vector<FrameJump> jumps = Find(frames);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_THAT(jumps[0].frames, ElementsAre(3, 9, 10, 25));
}

TEST_F(FrameJumpsTest, ShuffledVerticesAreFoundInWholeAndInPart) {
  for (const double share : {1.0, .3, .1}) {
    for (const int t : {0, 8, 19}) {
      Frames frames = MakeFrames(tube_, 20, 1);
      frames[t] = Shuffled(frames[t], share, 7);
      const std::vector<FrameJump> jumps = Find(frames);
      ASSERT_EQ(jumps.size(), 1u) << share << " " << t;
      EXPECT_THAT(jumps[0].frames, ElementsAre(t));
      EXPECT_FALSE(jumps[0].is_scaled_only());
    }
  }
}

// The edges of a cube are 1, 1.41 or 1.73 long in any order: small meshes jump by little.
TEST_F(FrameJumpsTest, AShuffledCubeIsFoundBetweenFramesThatAreAlike) {
  const MeshShape box = MakeBox({1, 1, 1});
  int num_found = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Frames frames(9, box.positions.cast<float>());
    frames[4] = Shuffled(frames[4], 1, seed);
    const std::vector<FrameJump> jumps = FindFrameJumps(Sequence(box, frames));
    const std::vector<float> lengths = EdgeLengths(SampleEdges(box.topology, 100), frames[4]);
    const bool has_moved = std::ranges::count_if(lengths, [](float x) { return x > 1.1f; }) > 1;
    EXPECT_EQ(jumps.size(), has_moved ? 1u : 0u) << seed;
    for (const FrameJump& jump : jumps) EXPECT_THAT(jump.frames, ElementsAre(4));
    num_found += !jumps.empty();
  }
  EXPECT_GT(num_found, 15);
}

TEST_F(FrameJumpsTest, WarningsNameFrameFileAndWhatToDo) {
  Frames frames = MakeFrames(tube_, 5, 1);
  frames[2] *= 10;
  const std::vector<InputNote> notes =
      DescribeJumps(Find(frames), {"f_1.obj", "f_2.obj", "f_3.obj", "f_4.obj", "f_5.obj"});
  EXPECT_TRUE(std::ranges::all_of(notes, IsJumpNote));
  EXPECT_FALSE(IsJumpNote({.kind = "face_order"}));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].severity, NoteSeverity::kWarning);
  EXPECT_EQ(notes[0].frame, 2);
  EXPECT_THAT(notes[0].text, AllOf(HasSubstr("frame 2 (f_3.obj)"), HasSubstr("times as large"),
                                   HasSubstr("edges x"), HasSubstr("Repair or remove it")));
}

TEST_F(FrameJumpsTest, TrainingIsRefusedWithTheFrameNumbers) {
  Frames frames = MakeFrames(tube_, 12, 1);
  EXPECT_THAT(RefuseFrameJumps(Sequence(tube_, frames)), IsOk());
  frames[2] = Shuffled(frames[2], 1, 3);
  EXPECT_THAT(RefuseFrameJumps(Sequence(tube_, frames)),
              HasStatus(absl::StatusCode::kFailedPrecondition,
                        AllOf(HasSubstr("clip 'clip'"), HasSubstr("frame 2 jumps"),
                              HasSubstr("--allow-jumps"))));
}

TEST_F(FrameJumpsTest, ShapesAreTheSameInAnyPoseAndOtherwiseNot) {
  const std::vector<Edge> edges = SampleEdges(tube_.topology, 1 << 14);
  const auto is_same = [&](const Eigen::Matrix3Xf& other) {
    return IsSameShape(CompareEdgeLengths(EdgeLengths(edges, tube_.positions.cast<float>()),
                                          EdgeLengths(edges, other)));
  };
  const Frames frames = MakeFrames(tube_, 6, 2);
  for (const Eigen::Matrix3Xf& frame : frames) {
    EXPECT_TRUE(is_same(frame));
    EXPECT_TRUE(is_same(frame * 100));
    EXPECT_FALSE(is_same(Shuffled(frame, 1, 1)));
    EXPECT_FALSE(is_same(Shuffled(frame, .2, 1)));
  }
  Eigen::Matrix3Xf other = frames[0];
  other.row(1) *= 4;
  EXPECT_FALSE(is_same(other));
}

}  // namespace
}  // namespace pleat
