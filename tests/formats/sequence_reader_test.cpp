#include "pleat/formats/sequence_reader.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "pleat/base/file.h"
#include "pleat/formats/alembic_writer.h"
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
    report_ = {};
    return ReadSequence(name.empty() ? folder_.path() : folder_.File(name), options, {}, &report_);
  }
  // All notes of the last Read, one a line.
  std::string Notes() const {
    std::string text;
    for (const InputNote& note : report_.notes) {
      text += absl::StrCat(SeverityName(note.severity), " ", note.kind, ": ", note.text, "\n");
    }
    return text;
  }
  // The faces of the box as other programs may list them.
  void WriteBoxWithFaces(const std::string& name, int t, const std::string& faces) {
    std::string text = EncodeObj(box_.topology, Frame(t));
    Write(name, text.substr(0, text.find("f ")) + faces);
  }

  const MeshShape box_ = MakeBox({1, 2, 3});
  const TemporaryFolder folder_;
  InputReport report_;
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
  EXPECT_THAT(Read("[a_1.obj"), HasStatus(absl::StatusCode::kNotFound, HasSubstr("pattern signs")));
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
  flipped.replace(at, 9, "f 1 6 5 2");
  Write("f3.obj", flipped);
  Write("f5.obj", flipped);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f3.obj"), HasSubstr("f0.obj"),
                                                  HasSubstr("face 2 joins vertices 0 5 4 1"))));
}

TEST_F(SequenceReaderTest, FacesListedInAnotherWayAreThoseOfTheFirstFrame) {
  const std::string text = EncodeObj(box_.topology, Frame(0));
  std::vector<std::string> faces =
      absl::StrSplit(text.substr(text.find("f ")), '\n', absl::SkipEmpty());
  ASSERT_EQ(faces.size(), 6u);
  WriteBox("f0.obj", 0);
  std::reverse(faces.begin(), faces.end());
  WriteBoxWithFaces("f1.obj", 1, absl::StrJoin(faces, "\n"));
  std::reverse(faces.begin(), faces.end());
  const auto turned =
      [&](std::vector<int> order) {  // of the corners of face 1, "f 5 6 7 8" or the like
        const std::vector<std::string> words = absl::StrSplit(faces[1], ' ');
        std::vector<std::string> other = faces;
        other[1] = "f";
        for (const int c : order)
          absl::StrAppend(&other[1], " ", words[1 + static_cast<size_t>(c)]);
        return absl::StrJoin(other, "\n");
      };
  WriteBoxWithFaces("f2.obj", 2, turned({2, 3, 0, 1}));
  WriteBoxWithFaces("f3.obj", 3, turned({0, 3, 2, 1}));
  WriteBoxWithFaces("f4.obj", 4, turned({1, 0, 3, 2}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read(""));
  ASSERT_EQ(sequence.num_frames(), 5);
  EXPECT_TRUE(sequence.topology() == box_.topology);
  for (int t = 0; t < 5; ++t) EXPECT_EQ(sequence.frame(t), Frame(t)) << t;
  EXPECT_EQ(report_.notes.size(), 3u) << Notes();
  EXPECT_THAT(Notes(),
              HasSubstr("face_order: frame 1 (f1.obj): 6 of 6 faces come in another order"));
  EXPECT_THAT(Notes(), HasSubstr("face_corners: frame 2 (f2.obj): 1 of 6 faces begin"));
  EXPECT_THAT(Notes(), HasSubstr("face_winding: frame 3 (f3.obj): 1 of 6 faces are wound the other "
                                 "way than in the first frame (f0.obj), whose faces are taken; "
                                 "alike in 2 of 5 frames"));
  // The same corners joined in another way are another face.
  WriteBoxWithFaces("f4.obj", 4, turned({0, 2, 1, 3}));
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f4.obj"), HasSubstr("face 1"))));
}

TEST_F(SequenceReaderTest, NotesOfFramesAreSaidOnceWithTheirNumber) {
  for (int t = 0; t < 20; ++t) {
    Write(absl::StrCat("f", t, ".obj"),
          EncodeObj(box_.topology, Frame(t)) + (t < 8 ? "" : "f 1 2\n"));
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read(""));
  EXPECT_EQ(sequence.num_frames(), 20);
  ASSERT_EQ(report_.notes.size(), 1u) << Notes();
  EXPECT_EQ(report_.notes[0].text,
            "frame 8 (f8.obj): 1 face with 2 corners left out (line 15); alike in 12 of 20 frames");
  EXPECT_EQ(report_.notes[0].frame, 8);
}

TEST_F(SequenceReaderTest, BracketsInNamesThatAreThereAreNoPattern) {
  WriteBox("take [v2]/f1.obj", 0);
  WriteBox("take [v2]/f2.obj", 1);
  WriteBox("take v/f1.obj", 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence by_pattern, Read("take [v2]/*.obj"));
  EXPECT_EQ(by_pattern.num_frames(), 2);
  EXPECT_EQ(by_pattern.name(), "take [v2]");
  EXPECT_THAT(Read("take [v2]"), IsOk());
  EXPECT_THAT(Read("take [v]/*.obj"), IsOk());  // not there: a pattern
  WriteBox("g[1]_1.obj", 0);
  WriteBox("g[1]_2.obj", 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence files, Read("g[1]_*.obj"));
  EXPECT_EQ(files.num_frames(), 2);
}

TEST_F(SequenceReaderTest, NamesOfSequencesAreUtf8) {
  WriteBox("B\xe6r_1.obj", 0);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read("B\xe6r_1.obj"));
  EXPECT_EQ(sequence.name(), "B\xc3\xa6r_1");
}

TEST_F(SequenceReaderTest, AlembicArchivesAreReadAloneAndInAFolder) {
  WriteBox("f0.obj", 0);
  WriteBox("f1.obj", 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence frames, Read(""));
  std::filesystem::create_directory(folder_.File("cache"));
  ASSERT_THAT(WriteAlembic(folder_.File("cache/a.abc"), frames), IsOk());
  for (const char* input : {"cache", "cache/a.abc", "cache/*.abc"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read(input, {.object = "/"}));
    EXPECT_EQ(sequence.name(), "a");
    EXPECT_EQ(sequence.topology(), box_.topology);
    ASSERT_EQ(sequence.num_frames(), 2);
    EXPECT_EQ(sequence.frame(1), Frame(1));
    EXPECT_EQ(Notes(), "");
  }
  EXPECT_THAT(Read("cache/a.abc", {.object = "/b"}),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no object '/b'")));
  Write("cache/renamed.obj", ReadFile(folder_.File("cache/a.abc")).value());
  EXPECT_THAT(Read("cache/renamed.obj"), HasStatus(kInvalid, HasSubstr("the ending .abc")));
}

TEST_F(SequenceReaderTest, ChoicesThatTheInputDoesNotHaveAreANote) {
  WriteBox("f0.obj", 0);
  for (const char* input : {"", "f0.obj", "*.obj"}) {
    EXPECT_THAT(Read(input, {.object = "/a"}), IsOk());
    EXPECT_THAT(Notes(), HasSubstr("object_ignored")) << input;
    EXPECT_THAT(Read(input, {.animation = "walk"}), IsOk());
    EXPECT_THAT(Notes(), HasSubstr("animation_ignored")) << input;
  }
}

TEST_F(SequenceReaderTest, ForeignFilesAreNamedWhateverTheirExtension) {
  for (const char* name : {"a.obj", "a.ply", "a.pc2", "a.pseq", "a.abc"}) {
    Write(name, "version https://git-lfs.github.com/spec/v1\noid sha256:12\n");
    EXPECT_THAT(Read(name), HasStatus(kInvalid, HasSubstr("git lfs pull"))) << name;
  }
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

TEST_F(SequenceReaderTest, EmptyAndDoubledFramesAreNamed) {
  WriteBox("f0.obj", 0);
  WriteBox("f1.obj", 1);
  Write("f2.obj", "# nothing\n");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("frame 2: "), HasSubstr("f2.obj"),
                                                  HasSubstr("empty"), HasSubstr("remove"))));
  Write("f2.obj", "");
  EXPECT_THAT(Read(""), HasStatus(kInvalid, AllOf(HasSubstr("f2.obj"), HasSubstr("empty"))));
  WriteBox("f2.obj", 2);
  WriteBox("f002.obj", 2);
  EXPECT_THAT(Read(""), HasStatus(kInvalid, HasSubstr("twice")));
}

TEST_F(SequenceReaderTest, UnknownInputListsWhatIsKnown) {
  Write("a.fbx", "Kaydara");
  EXPECT_THAT(Read("a.fbx"),
              HasStatus(kInvalid, AllOf(HasSubstr("'.fbx'"),
                                        HasSubstr(".obj, .ply, .drc, .glb, .gltf, .pc2, .mdd"))));
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

TEST_F(SequenceReaderTest, TheMeshOfAPointCacheIsNamedAndCompared) {
  WriteCache("a.pc2", 2);
  WriteBox("box.obj", 0);
  ASSERT_THAT(Read("a.pc2"), IsOk());
  EXPECT_EQ(Notes(), "note mesh_taken: a.pc2: its mesh is taken from box.obj\n");
  WriteBox("a.obj", 5);  // another size is no other shape
  ASSERT_THAT(Read("a.pc2"), IsOk());
  EXPECT_THAT(Notes(), HasSubstr("note mesh_scaled: a.pc2: frame 0 is 0.167 times as large"));
  Eigen::Matrix3Xf reversed = Frame(0).rowwise().reverse();
  reversed.col(0).swap(reversed.col(3));
  Write("a.obj", EncodeObj(box_.topology, reversed));
  ASSERT_THAT(Read("a.pc2"), IsOk());
  EXPECT_THAT(Notes(), AllOf(HasSubstr("warning mesh_differs"), HasSubstr("a.obj"),
                             HasSubstr("another order")));
}

TEST_F(SequenceReaderTest, APartnerThatCannotBeReadReportsItsOwnError) {
  WriteCache("a.pc2", 2);
  Write("other.obj", "v 0 0 zero\n");
  EXPECT_THAT(Read("a.pc2"),
              HasStatus(kInvalid, AllOf(HasSubstr("other.obj:1"), HasSubstr("found 'zero'"))));
  Write("a.obj", "v 0 0 zero\n");
  EXPECT_THAT(Read("a.pc2"),
              HasStatus(kInvalid, AllOf(HasSubstr("mesh of"), HasSubstr("a.obj:1"))));
}

TEST_F(SequenceReaderTest, TimesOfAPointCacheAreNamed) {
  WriteBox("a.obj", 0);
  PointCache cache;
  cache.frames = {Frame(0), Frame(0)};
  const auto notes = [&](float start, float rate) {
    cache.start_frame = start;
    cache.sample_rate = rate;
    EXPECT_THAT(WritePointCache(folder_.File("a.pc2"), cache), IsOk());
    EXPECT_THAT(Read("a.pc2"), IsOk());
    return Notes();
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(notes(0, 1), "");
  EXPECT_THAT(notes(10, .5f), AllOf(HasSubstr("note times_ignored"), HasSubstr("start 10"),
                                    HasSubstr("0.5 frames per sample"), HasSubstr("--fps")));
  for (const auto& [start, rate] :
       std::vector<std::pair<float, float>>{{0, 0}, {kNan, 1}, {0, kNan}, {0, -1}}) {
    EXPECT_THAT(notes(start, rate), HasSubstr("warning times_invalid")) << start << " " << rate;
  }
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
