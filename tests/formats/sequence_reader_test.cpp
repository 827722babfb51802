#include "pleat/formats/sequence_reader.h"

#include <limits>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/sequence_file.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

class SequenceReaderTest : public testing::Test {
 protected:
  // A box whose frames are scaled by 1 + frame.
  Eigen::Matrix3Xf Frame(int t) const { return box_.positions.cast<float>() * (1.0f + t); }
  void Write(const std::string& name, const std::string& text) {
    ASSERT_THAT(WriteFile(folder_.File(name), text), IsOk());
  }
  void WriteBox(const std::string& name, int t) { Write(name, EncodeObj(box_.topology, Frame(t))); }
  void WriteCache(const std::string& name, int num_frames, int num_vertices = 8) {
    PointCache cache;
    for (int t = 0; t < num_frames; ++t) cache.frames.push_back(Frame(t).leftCols(num_vertices));
    ASSERT_THAT(WritePointCache(folder_.File(name), cache), IsOk());
  }
  absl::StatusOr<MeshSequence> Read(const std::string& name, ReadSequenceOptions options = {}) {
    return ReadSequence(name.empty() ? folder_.path() : folder_.File(name), options);
  }

  const MeshShape box_ = MakeBox({1, 2, 3});
  const TemporaryFolder folder_;
};

TEST_F(SequenceReaderTest, FolderInNaturalOrder) {
  for (int t = 0; t < 12; ++t) WriteBox(absl::StrCat("f", t, ".obj"), t);
  Write("materials.mtl", "newmtl x\n");
  Write(".hidden.obj", "broken");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read(""));
  ASSERT_EQ(sequence.num_frames(), 12);
  for (int t = 0; t < 12; ++t) EXPECT_EQ(sequence.frame(t), Frame(t)) << t;
  EXPECT_TRUE(sequence.topology() == box_.topology);
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{30, 1}));
}

TEST_F(SequenceReaderTest, PatternTakesItsFilesOnly) {
  WriteBox("a_1.obj", 0);
  WriteBox("a_2.obj", 1);
  WriteBox("b_1.obj", 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             Read("a_*.obj", {.frame_rate = FrameRate{25, 1}}));
  EXPECT_EQ(sequence.num_frames(), 2);
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{25, 1}));
  EXPECT_THAT(Read(""), HasStatus(kInvalid, HasSubstr("does not belong")));
  EXPECT_THAT(Read("c_*.obj"), HasStatus(absl::StatusCode::kNotFound, HasSubstr("c_*.obj")));
}

TEST_F(SequenceReaderTest, ResultDoesNotDependOnThreads) {
  for (int t = 0; t < 40; ++t) WriteBox(absl::StrCat("f", t, ".obj"), t);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence one, Read("", {.num_threads = 1}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence four, Read("", {.num_threads = 4}));
  EXPECT_EQ(EncodeSequence(one), EncodeSequence(four));
}

TEST_F(SequenceReaderTest, FirstFrameThatDiffersIsNamedWithItsFace) {
  for (int t = 0; t < 6; ++t) WriteBox(absl::StrCat("f", t, ".obj"), t);
  std::string flipped = EncodeObj(box_.topology, Frame(3));
  const size_t at = flipped.find("f 1 2 6 5");
  ASSERT_NE(at, std::string::npos);
  flipped.replace(at, 9, "f 1 5 6 2");
  Write("f3.obj", flipped);
  Write("f5.obj", flipped);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f3.obj"), HasSubstr("f0.obj"),
                                                  HasSubstr("face 2 joins vertices 0 4 5 1"))));
}

TEST_F(SequenceReaderTest, WrongCountsAreNamed) {
  WriteBox("f0.obj", 0);
  Write("f1.obj", EncodeObj(box_.topology, Frame(1)) + "v 0 0 0\n");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f1.obj"), HasSubstr("9 vertices"))));
  Write("f1.obj", EncodeObj(box_.topology, Frame(1)) + "f 1 2 3\n");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("7 faces"), HasSubstr("face 6"))));
}

TEST_F(SequenceReaderTest, NotANumberIsNamedWithFrameAndVertex) {
  WriteBox("f0.obj", 0);
  std::string text = EncodeObj(box_.topology, Frame(1));
  text.replace(text.find("\nv ", 5), 3, "\nv nan ");  // second vertex
  Write("f1.obj", text);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("frame 1"), HasSubstr("f1.obj"),
                                                  HasSubstr("vertex 1"))));
}

TEST_F(SequenceReaderTest, EmptyAndMissingAndDoubledFramesAreNamed) {
  WriteBox("f0.obj", 0);
  WriteBox("f1.obj", 1);
  WriteBox("f3.obj", 3);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, HasSubstr("number 2 is missing")));
  Write("f2.obj", "");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f2.obj"), HasSubstr("empty"))));
  WriteBox("f2.obj", 2);
  WriteBox("f002.obj", 2);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, HasSubstr("twice")));
}

TEST_F(SequenceReaderTest, UnknownInputListsWhatIsKnown) {
  Write("a.fbx", "Kaydara");
  EXPECT_THAT(
      Read("a.fbx"),
      HasStatus(kInvalid, AllOf(HasSubstr("'.fbx'"), HasSubstr(".obj, .ply, .drc, .pc2, .pseq"))));
  EXPECT_THAT(Read(""), HasStatus(absl::StatusCode::kNotFound,
                                  AllOf(HasSubstr(".obj, .ply"), HasSubstr("'.fbx'"))));
  EXPECT_THAT(Read("*.fbx"), HasStatus(kInvalid, HasSubstr("unknown extension")));
  EXPECT_THAT(Read("absent"), HasStatus(absl::StatusCode::kNotFound, HasSubstr("absent")));
}

TEST_F(SequenceReaderTest, DracoIsReadByThoseWhoBringAReader) {
  Write("d0.drc", "DRACO");
  EXPECT_THAT(Read("d0.drc"), HasStatus(kInvalid, HasSubstr("not read here")));
}

TEST_F(SequenceReaderTest, MixedKindsAreRefused) {
  WriteBox("f0.obj", 0);
  Write("f1.ply", "ply\n");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, HasSubstr(".obj, .ply")));
}

TEST_F(SequenceReaderTest, PointCacheWithMeshOfTheSameStem) {
  WriteBox("a.obj", 5);
  WriteCache("a.pc2", 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read("a.pc2"));
  ASSERT_EQ(sequence.num_frames(), 4);
  EXPECT_EQ(sequence.frame(0), Frame(0));  // all positions come from the cache
  EXPECT_EQ(sequence.name(), "a");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence by_folder, Read(""));
  EXPECT_EQ(EncodeSequence(by_folder), EncodeSequence(sequence));
}

TEST_F(SequenceReaderTest, PointCacheFallsBackToTemplateThenToTheOneThatFits) {
  WriteCache("a.pc2", 2);
  EXPECT_THAT(Read("a.pc2"), HasStatus(absl::StatusCode::kNotFound, HasSubstr("template.obj")));
  const MeshShape sphere = MakeUvSphere(1, 3, 5);
  Write("sphere.obj", EncodeObj(sphere.topology, sphere.positions.cast<float>()));
  WriteBox("box.obj", 0);
  EXPECT_THAT(Read("a.pc2"), IsOk());
  WriteBox("box2.obj", 0);
  EXPECT_THAT(Read("a.pc2"), HasStatus(kInvalid, HasSubstr("box.obj, box2.obj")));
  WriteBox("template.obj", 0);
  EXPECT_THAT(Read("a.pc2"), IsOk());
  Write("a.obj", EncodeObj(sphere.topology, sphere.positions.cast<float>()));
  EXPECT_THAT(Read("a.pc2"), HasStatus(kInvalid, AllOf(HasSubstr("8 vertices"), HasSubstr("17"))));
}

TEST_F(SequenceReaderTest, SingleMeshAndPleatFile) {
  WriteBox("only.obj", 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence one, Read("only.obj"));
  EXPECT_EQ(one.num_frames(), 1);
  ASSERT_THAT(WriteSequenceFile(folder_.File("s.pseq"), one), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence same, Read("s.pseq"));
  EXPECT_EQ(EncodeSequence(same), EncodeSequence(one));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence faster,
                             Read("s.pseq", {.frame_rate = FrameRate{60, 1}}));
  EXPECT_EQ(faster.frame_rate(), (FrameRate{60, 1}));
  EXPECT_EQ(faster.name(), "only");
}

TEST_F(SequenceReaderTest, LimitsOnFramesAndBytes) {
  for (int t = 0; t < 4; ++t) WriteBox(absl::StrCat("f", t, ".obj"), t);
  EXPECT_THAT(Read("", {.limits = {.max_frames = 3}}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("4 frames")));
  EXPECT_THAT(Read("", {.limits = {.max_sequence_bytes = 300}}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("300 bytes")));
}

TEST_F(SequenceReaderTest, ProgressIsToldAndCancellationStopsIt) {
  for (int t = 0; t < 40; ++t) WriteBox(absl::StrCat("f", t, ".obj"), t);
  double last = -1;
  int num_reports = 0;
  const Progress progress(
      [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last);
        last = update.fraction;
        ++num_reports;
      },
      nullptr);
  EXPECT_THAT(ReadSequence(folder_.path(), {}, progress), IsOk());
  EXPECT_EQ(last, 1);
  EXPECT_GT(num_reports, 3);
  int num_tests = 0;
  const Progress cancelled(nullptr, [&] { return ++num_tests > 2; });
  EXPECT_THAT(ReadSequence(folder_.path(), {}, cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
