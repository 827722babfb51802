#include <gmock/gmock.h>

#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"
#include "support/hostile_bytes.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kSmall[] = R"(HIERARCHY
ROOT hips
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT knee
  {
    OFFSET 0 -40 0
    CHANNELS 3 Zrotation Yrotation Xrotation
    End Site
    {
      OFFSET 0 -45 0
    }
  }
}
MOTION
Frames: 2
Frame Time: .0083333
1 91 2 30 0 0 10 20 30
1.5 92 3 -30 45 60 0 0 -90
)";

absl::StatusOr<BvhFile> Replaced(const std::string& before, const std::string& after,
                                 const MeshLimits& limits = {}) {
  return DecodeBvh(absl::StrReplaceAll(kSmall, {{before, after}}), limits);
}

Eigen::Quaterniond Turn(int axis, double degrees) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::Unit(axis)));
}

TEST(BvhReaderTest, RotationsAreAppliedInTheOrderOfTheirChannels) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(kSmall));
  EXPECT_THAT(file.warnings, IsEmpty());
  const JointClip& clip = file.clip;
  ASSERT_EQ(clip.num_frames(), 2u);
  ASSERT_EQ(clip.num_joints(), 3u);
  EXPECT_EQ(clip.fps, 120);
  EXPECT_LT(clip.rotations[1].angularDistance(Turn(2, 10) * Turn(1, 20) * Turn(0, 30)), 1e-12);
  EXPECT_LT(clip.rotations[3].angularDistance(Turn(2, -30) * Turn(0, 45) * Turn(1, 60)), 1e-12);
  EXPECT_EQ(clip.translations[0], Eigen::Vector3d(1, 91, 2));  // in place of the offset
  EXPECT_EQ(clip.translations[1], Eigen::Vector3d(0, -40, 0));
  EXPECT_TRUE(clip.joints[2].is_end);
}

TEST(BvhReaderTest, PositionsOfJointsReplaceOffsetsOrAreAddedToThem) {
  const std::string joint = "CHANNELS 4 Yposition Zrotation Yrotation Xrotation";
  const auto knee = [&](const std::string& first, const std::string& second) {
    return DecodeBvh(
        absl::StrReplaceAll(kSmall, {{"CHANNELS 3 Zrotation Yrotation Xrotation", joint},
                                     {"10 20 30", first + " 10 20 30"},
                                     {"0 0 -90", second + " 0 0 -90"}}));
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile replacing, knee("-41", "-39"));
  EXPECT_EQ(replacing.clip.translations[1], Eigen::Vector3d(0, -41, 0));
  EXPECT_THAT(replacing.warnings, IsEmpty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile adding, knee("-1", "1"));
  EXPECT_EQ(adding.clip.translations[1], Eigen::Vector3d(0, -41, 0));
  EXPECT_EQ(adding.clip.translations[4], Eigen::Vector3d(0, -39, 0));
  EXPECT_THAT(adding.warnings, ElementsAre(AllOf(HasSubstr("additions"), HasSubstr("'knee'"))));
}

TEST(BvhReaderTest, WrongCountsOfFramesAreSaidAndAllFramesTaken) {
  for (const char* count : {"1", "3", "0", "-7"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file,
                               Replaced("Frames: 2", absl::StrCat("Frames: ", count)));
    EXPECT_EQ(file.clip.num_frames(), 2u);
    EXPECT_THAT(file.warnings,
                ElementsAre(HasSubstr(absl::StrCat("has ", count, " frames, and holds 2"))));
  }
  EXPECT_THAT(Replaced("Frames: 2", "Frames: two"), HasStatus(kInvalid, HasSubstr("'two'")));
}

TEST(BvhReaderTest, ALastFrameThatIsCutOffIsLeftOutAndSaid) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, Replaced("60 0 0 -90", "60"));
  EXPECT_EQ(file.clip.num_frames(), 1u);
  EXPECT_THAT(file.warnings,
              ElementsAre(HasSubstr("6 of 9"), HasSubstr("has 2 frames, and holds 1")));
}

TEST(BvhReaderTest, FramesMayGoOverLinesButNotMissAValue) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, Replaced("1 91 2 30", "1 91\n2 30"));
  EXPECT_EQ(file.clip.num_frames(), 2u);
  EXPECT_THAT(Replaced("1 91 2 30", "1 91 2"),
              HasStatus(kInvalid, AllOf(HasSubstr("line 20"), HasSubstr("more than 9"))));
  EXPECT_THAT(Replaced("10 20 30", "10 nan 30"),
              HasStatus(kInvalid, AllOf(HasSubstr("line 19"), HasSubstr("frame 0"),
                                        HasSubstr("'knee'"), HasSubstr("'nan'"))));
}

TEST(BvhReaderTest, FrameTimesAreTheUsualRatesTheyWereRoundedFrom) {
  for (const auto& [text, fps] :
       std::vector<std::pair<std::string, double>>{{"0.033333", 30},
                                                   {".033", 30},
                                                   {"0.0333667", 30000. / 1001},
                                                   {"0.04", 25},
                                                   {"0.041667", 24},
                                                   {"0.0166667", 60},
                                                   {"0.01", 100},
                                                   {"5e-2", 20},
                                                   {"0.07", 1 / .07}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, Replaced(".0083333", text));
    EXPECT_DOUBLE_EQ(file.clip.fps, fps) << text;
  }
  for (const char* wrong : {"0", "-1", "x", "1e-9"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, Replaced(".0083333", wrong));
    EXPECT_EQ(file.clip.fps, 30);
    EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("30 frames per second are taken")));
  }
}

TEST(BvhReaderTest, LineEndsAndAMarkAtTheFrontDoNotMatter) {
  const std::string text = kSmall;
  for (const std::string& other :
       {absl::StrReplaceAll(text, {{"\n", "\r\n"}}), absl::StrReplaceAll(text, {{"\n", "\r"}}),
        "\xef\xbb\xbf" + text, absl::StrReplaceAll(text, {{" ", "\t "}})}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(other));
    EXPECT_EQ(file.clip.num_frames(), 2u);
  }
  EXPECT_TRUE(IsBvhText("\n hierarchy\n"));
  EXPECT_FALSE(IsBvhText("{\"schema\""));
}

TEST(BvhReaderTest, LimitsAreKept) {
  const auto is_exhausted = HasStatus(absl::StatusCode::kResourceExhausted, testing::_);
  EXPECT_THAT(DecodeBvh(kSmall, {.max_document_bytes = 100}), is_exhausted);
  EXPECT_THAT(DecodeBvh(kSmall, {.max_frames = 1}), is_exhausted);
  // Many joints and frames from few bytes: a joint costs 10, a frame 2.
  std::string text = "HIERARCHY\nROOT r\n{\nCHANNELS 1 Xrotation\n";
  for (int j = 0; j < 4000; ++j) text += "JOINT j\n{\n}\n";
  text += "}\nMOTION\nFrames: 3000\nFrame Time: 1\n";
  for (int t = 0; t < 3000; ++t) text += "1\n";
  EXPECT_THAT(DecodeBvh(text), is_exhausted);
}

TEST(BvhReaderTest, DamagedTextIsReadOrRefusedButNothingElse) {
  size_t num_read = 0;
  ForEachTruncation(kSmall, [&](const std::string& bytes) {
    const absl::StatusOr<BvhFile> file = DecodeBvh(bytes);
    if (!file.ok()) return;
    ++num_read;
    EXPECT_LE(file->clip.num_frames(), 2u);
  });
  EXPECT_GT(num_read, 10u);
  ForEachCorruption(kSmall, [](const std::string& bytes) {
    const absl::StatusOr<BvhFile> file = DecodeBvh(bytes);
    if (!file.ok()) return;
    EXPECT_EQ(file->clip.rotations.size(), file->clip.num_joints() * file->clip.num_frames());
    for (const Eigen::Quaterniond& q : file->clip.rotations) EXPECT_NEAR(q.norm(), 1, 1e-9);
  });
}

struct RealClip {
  std::string name;
  size_t num_joints, num_frames;
  double fps, unit_m;
  std::vector<std::string> warnings;
};

TEST(BvhReaderTest, RealClipsAreRead) {
  const std::vector<RealClip> clips = {
      {"01_01", 31, 2752, 120, .0254 / .45, {}},
      {"131_01", 31, 994, 120, .0254 / .45, {}},
      {"131_02", 31, 1247, 120, .0254 / .45, {}},
      {"Boxing_Toes", 21, 3070, 100, .01, {"3069 frames, and holds 3070"}},
      {"jesse_dance", 60, 1007, 100, .01, {}},
      {"bandai_walk_normal", 22, 195, 30, .01, {}},
  };
  PLEAT_SHARED_DATA_OR_SKIP(first, "bvh/01_01.bvh");
  for (const RealClip& expected : clips) {
    PLEAT_SHARED_DATA_OR_SKIP(path, "bvh/" + expected.name + ".bvh");
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string text, ReadFile(path));
    PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(text));
    const auto num_joints = std::ranges::count(file.clip.joints, false, &ClipJoint::is_end);
    EXPECT_EQ(static_cast<size_t>(num_joints), expected.num_joints) << expected.name;
    EXPECT_EQ(file.clip.num_frames(), expected.num_frames) << expected.name;
    EXPECT_EQ(file.clip.fps, expected.fps) << expected.name;
    EXPECT_EQ(GuessUnit(file.clip).unit_m, expected.unit_m)
        << expected.name << " " << GuessUnit(file.clip).size;
    ASSERT_EQ(file.warnings.size(), expected.warnings.size()) << expected.name;
    for (size_t i = 0; i < file.warnings.size(); ++i) {
      EXPECT_THAT(file.warnings[i], HasSubstr(expected.warnings[i]));
    }
  }
}

}  // namespace
}  // namespace pleat
