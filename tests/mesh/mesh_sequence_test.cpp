#include "pleat/mesh/mesh_sequence.h"

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Topology Triangle() { return *Topology::Create(3, {0, 1, 2}, {3}); }
std::vector<Eigen::Matrix3Xf> CountingFrames(int count) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < count; ++t) frames.push_back(Eigen::Matrix3Xf::Constant(3, 3, float(t)));
  return frames;
}

TEST(MeshSequenceTest, HoldsWhatItWasGiven) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             MeshSequence::Create(Triangle(), CountingFrames(4),
                                                  {.name = "s", .frame_rate = {30000, 1001}}));
  EXPECT_EQ(sequence.num_frames(), 4);
  EXPECT_EQ(sequence.num_vertices(), 3);
  EXPECT_NEAR(sequence.frame_rate().fps(), 29.97, 1e-2);
  EXPECT_EQ(sequence.FrameAsDouble(2), Eigen::Matrix3Xd::Constant(3, 3, 2));
}

TEST(MeshSequenceTest, NamesFrameAndVertexOfWhatIsNotFinite) {
  std::vector<Eigen::Matrix3Xf> frames = CountingFrames(5);
  frames[3](1, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(MeshSequence::Create(Triangle(), frames),
              HasStatus(kInvalid, AllOf(HasSubstr("frame 3"), HasSubstr("vertex 2"))));
  frames = CountingFrames(2);
  frames[1](0, 0) = -std::numeric_limits<float>::infinity();
  MeshSequenceOptions options;
  options.frame_names = {"a.obj", "b.obj"};
  EXPECT_THAT(MeshSequence::Create(Triangle(), frames, options),
              HasStatus(kInvalid, AllOf(HasSubstr("'b.obj'"), HasSubstr("vertex 0"))));
}

TEST(MeshSequenceTest, RefusesWrongCountsAndRates) {
  EXPECT_FALSE(MeshSequence::Create(Triangle(), {}).ok());
  std::vector<Eigen::Matrix3Xf> frames = CountingFrames(3);
  frames[2].resize(3, 4);
  EXPECT_THAT(MeshSequence::Create(Triangle(), frames),
              HasStatus(kInvalid, AllOf(HasSubstr("frame 2"), HasSubstr("4 vertices"))));
  for (const FrameRate rate : {FrameRate{0, 1}, FrameRate{30, 0}, FrameRate{-1, -1}}) {
    EXPECT_THAT(
        MeshSequence::Create(Triangle(), CountingFrames(1), {.name = "", .frame_rate = rate}),
        HasStatus(kInvalid, HasSubstr("frame rate")));
  }
}

TEST(MeshSequenceTest, RefusesAnAppearanceThatDoesNotFit) {
  MeshSequenceOptions options;
  options.appearance.texcoords = {{0, 0}, {1, 0}};
  options.appearance.corner_texcoords = {0, 1, 2};
  EXPECT_THAT(MeshSequence::Create(Triangle(), CountingFrames(1), options),
              HasStatus(kInvalid, HasSubstr("entry 2")));
  options.appearance.corner_texcoords = {0, 1};
  EXPECT_FALSE(MeshSequence::Create(Triangle(), CountingFrames(1), options).ok());
  options.appearance.corner_texcoords = {0, -1, 1};
  EXPECT_TRUE(MeshSequence::Create(Triangle(), CountingFrames(1), options).ok());
  options.appearance.face_materials = {0};
  EXPECT_THAT(MeshSequence::Create(Triangle(), CountingFrames(1), options),
              HasStatus(kInvalid, HasSubstr("materials")));
}

TEST(MeshSequenceTest, SubsetTakesFramesInTheGivenOrder) {
  const MeshSequence sequence = *MeshSequence::Create(Triangle(), CountingFrames(4), {.name = "s"});
  const MeshSequence subset = sequence.Subset({3, 1, 1});
  ASSERT_EQ(subset.num_frames(), 3);
  EXPECT_EQ(subset.frame(0)(0, 0), 3);
  EXPECT_EQ(subset.frame(2)(0, 0), 1);
  EXPECT_EQ(subset.name(), "s");
}

TEST(MeshSequenceTest, JoinedClipsShareTheirFrames) {
  const MeshSequence first =
      *MeshSequence::Create(Triangle(), CountingFrames(2), {.name = "first"});
  const MeshSequence second =
      *MeshSequence::Create(Triangle(), CountingFrames(3), {.name = "second"});
  const MeshSequence joined = MeshSequence::Join({first, second});
  ASSERT_EQ(joined.num_frames(), 5);
  EXPECT_EQ(joined.name(), "first");
  EXPECT_EQ(&joined.frame(1), &first.frame(1));
  EXPECT_EQ(&joined.frame(4), &second.frame(2));
}

}  // namespace
}  // namespace pleat
