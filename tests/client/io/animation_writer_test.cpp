#include "cli/io/animation_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "cli/exit_code.h"
#include "cli/io/input.h"
#include "client/test_sequence.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

absl::Status Write(const std::string& path, const std::string& format, const MeshSequence& sequence,
                   FrameEncoding encoding = FrameEncoding::kDracoMesh) {
  const absl::StatusOr<AnimationFormat> chosen = ChooseAnimationFormat(format, path);
  if (!chosen.ok()) return chosen.status();
  AnimationOptions options;
  options.frame_rate = sequence.frame_rate();
  options.name = sequence.name();
  options.encoder.encoding = encoding;
  const auto writer = MakeAnimationWriter(*chosen, path, sequence.topology(), options);
  for (int t = 0; t < sequence.num_frames(); ++t) {
    if (absl::Status status = writer->AddFrame(sequence.frame(t)); !status.ok()) return status;
  }
  return writer->Finish();
}

absl::StatusOr<MeshSequence> Read(const std::string& path) {
  std::ostringstream out, err;
  Session session;
  session.out = &out;
  session.err = &err;
  session.quiet = true;
  return ReadInput(session, path);
}

TEST(AnimationWriter, ChoosesByTheEnding) {
  EXPECT_EQ(*ChooseAnimationFormat("auto", "a/b.pc2"), AnimationFormat::kPc2);
  EXPECT_EQ(*ChooseAnimationFormat("auto", "a/b.pseq"), AnimationFormat::kPseq);
  EXPECT_EQ(*ChooseAnimationFormat("auto", "a/b.abc"), AnimationFormat::kAbc);
  EXPECT_EQ(*ChooseAnimationFormat("abc", "a/b"), AnimationFormat::kAbc);
  EXPECT_EQ(*ChooseAnimationFormat("auto", "a/b"), AnimationFormat::kDraco);
  EXPECT_EQ(*ChooseAnimationFormat("obj", "a/b.pc2"), AnimationFormat::kObj);
  EXPECT_TRUE(IsUsageError(ChooseAnimationFormat("gif", "a/b").status()));
}

class EveryFormat : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(EveryFormat, ComesBackAsItWas) {
  const auto [name, format] = GetParam();
  const TemporaryFolder folder;
  const MeshSequence sequence = MovingTetrahedron(12);
  ASSERT_THAT(Write(folder.File(name), format, sequence), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, Read(folder.File(name)));
  ASSERT_EQ(back.num_frames(), 12);
  // Draco rounds to its grid, 12 bits over 1.25 edges of about 1 m; the others are exact.
  const double tolerance = format == std::string("drc") ? 0.5 * 1.25 / 4095 * 1.01 : 0;
  for (int t = 0; t < 12; ++t) {
    EXPECT_LE((back.frame(t) - sequence.frame(t)).cwiseAbs().maxCoeff(), tolerance) << t;
  }
}

INSTANTIATE_TEST_SUITE_P(AnimationWriter, EveryFormat,
                         ::testing::Values(std::pair("a.pc2", "auto"), std::pair("a.pseq", "auto"),
                                           std::pair("a.abc", "auto"), std::pair("objs", "obj"),
                                           std::pair("plys", "ply"), std::pair("drcs", "drc")));

TEST(AnimationWriter, DracoFoldersKeepTheFrameRateInBothEncodings) {
  const TemporaryFolder folder;
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    ASSERT_THAT(Write(folder.File("drc"), "drc", MovingTetrahedron(3), encoding), IsOk());
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, Read(folder.File("drc")));
    EXPECT_EQ(back.num_frames(), 3);
    EXPECT_EQ(back.frame_rate(), (FrameRate{24, 1}));
  }
}

TEST(AnimationWriter, AShorterAnimationLeavesNoFramesOfALongerOne) {
  const TemporaryFolder folder;
  for (const char* format : {"obj", "drc"}) {
    ASSERT_THAT(Write(folder.File(format), format, MovingTetrahedron(12)), IsOk());
    ASSERT_THAT(Write(folder.File(format), format, MovingTetrahedron(5)), IsOk());
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, Read(folder.File(format)));
    EXPECT_EQ(back.num_frames(), 5) << format;
  }
}

TEST(AnimationWriter, NoFramesIsAnError) {
  const TemporaryFolder folder;
  for (const char* format : {"pc2", "abc", "pseq", "obj", "ply", "drc"}) {
    const auto writer =
        MakeAnimationWriter(*ChooseAnimationFormat(format, "x"), folder.File(format),
                            MovingTetrahedron(1).topology(), {});
    EXPECT_EQ(writer->Finish().code(), absl::StatusCode::kInvalidArgument) << format;
  }
}

}  // namespace
}  // namespace pleat
