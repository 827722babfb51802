#include "pleat/formats/obj_reader.h"

#include <gmock/gmock.h>

#include "absl/strings/str_cat.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

absl::StatusOr<MeshFile> DecodeText(std::string_view text, const MeshLimits& limits = {}) {
  return DecodeObj(text, "m.obj", limits);
}

constexpr char kFour[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReaderTest, ReadsVerticesAndEveryFormOfFace) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText(absl::StrCat("# comment\n", kFour,
                              "v -1.5e-2 +2 3e1 1.0 0.2 0.3\nvt 0 0\nvt 1 0.5 0\nvn 0 0 1\n"
                              "f 1 2 3\nf 1/1 2/2 3/1 4/2\nf 1//1 3//1 4//1\n"
                              "f 1/1/1 2/2/1 3/1/1 4/2/1 5/1/1\nf -5 -4 -1\n")));
  EXPECT_EQ(mesh.positions.cols(), 5);
  EXPECT_EQ(mesh.positions.col(4), Eigen::Vector3f(-1.5e-2f, 2, 30));
  ASSERT_EQ(mesh.topology.num_faces(), 5);
  EXPECT_THAT(mesh.topology.face(0), ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh.topology.face(1), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(mesh.topology.face(2), ElementsAre(0, 2, 3));
  EXPECT_THAT(mesh.topology.face(3), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(mesh.topology.face(4), ElementsAre(0, 1, 4));
  EXPECT_THAT(mesh.appearance.corner_texcoords,
              ElementsAre(-1, -1, -1, 0, 1, 0, 1, -1, -1, -1, 0, 1, 0, 1, 0, -1, -1, -1));
  EXPECT_EQ(mesh.appearance.texcoords[1], Eigen::Vector2f(1, 0.5f));
}

TEST(ObjReaderTest, KeepsDoubledAndLooseVertices) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText("v 0 0 0\nv 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nf 1 4 5\nf 2 5 4\n"));
  EXPECT_EQ(mesh.positions.cols(), 5);
  EXPECT_THAT(mesh.topology.face(1), ElementsAre(1, 4, 3));
}

TEST(ObjReaderTest, KeepsMaterials) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText(
          absl::StrCat("mtllib my file.mtl\n", kFour,
                       "f 1 2 3\nusemtl red cloth\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl red cloth\n"
                       "f 1 2 3\n")));
  EXPECT_EQ(mesh.appearance.material_library, "my file.mtl");
  EXPECT_THAT(mesh.appearance.material_names, ElementsAre("red cloth", "b"));
  EXPECT_THAT(mesh.appearance.face_materials, ElementsAre(-1, 0, 1, 0));
}

TEST(ObjReaderTest, LineEndsContinuationsAndForwardReferences) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh,
                             DecodeText("f 1 2 \\\r\n 3\r\nv 0 0 0\r\n\r\nv 1 0 0\r\nv 0 1 0"));
  EXPECT_THAT(mesh.topology.face(0), ElementsAre(0, 1, 2));
  EXPECT_EQ(mesh.positions(1, 2), 1);
}

// Whatever stands around the statements, the vertices and faces are these.
void ExpectTwoTriangles(const std::string& text) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeText(text));
  ASSERT_EQ(mesh.positions.cols(), 4) << text;
  EXPECT_EQ(mesh.positions.col(0), Eigen::Vector3f(0, 0, 0)) << text;
  EXPECT_EQ(mesh.positions.col(3), Eigen::Vector3f(0, 1, 0)) << text;
  ASSERT_EQ(mesh.topology.num_faces(), 2) << text;
  EXPECT_THAT(mesh.topology.face(0), ElementsAre(0, 1, 2)) << text;
  EXPECT_THAT(mesh.topology.face(1), ElementsAre(0, 2, 3)) << text;
}

TEST(ObjReaderTest, NoLineIsLostToAByteOrderMarkABackslashOrAComment) {
  const std::string faces = "f 1 2 3\nf 1 3 4\n";
  ExpectTwoTriangles(absl::StrCat("\xef\xbb\xbf", kFour, faces));
  for (const char* line : {"# C:\\meshes\\", "mtllib C:\\m\\", "o a\\", "g a \\", "usemtl m\\",
                           "unknown 1 \\", "\\", "#\\", "s 1\\"}) {
    ExpectTwoTriangles(absl::StrCat(line, "\n", kFour, line, "\n", faces));
    ExpectTwoTriangles(absl::StrCat(line, "\r\n", kFour, line, "\r\n", faces));
  }
  // A comment at the end of a statement is not continued either; the statement itself is.
  ExpectTwoTriangles(
      "v 0 0 0 # a\\\nv 1 0 0#b\\\nv 1 1 0\nv 0 \\\n1 \\\n0\nf 1 2 3# c\\\nf 1 \\\n3 4\n");
  ExpectTwoTriangles(
      "v 0 0 0#\nv 1 0 0#origin\nv 1 1 0 #\nv 0 1 0\nvt 0#\nf 1 2 3/1/1#x\n f 1 3 4#\n");
}

TEST(ObjReaderTest, LinesMayEndInAnyWay) {
  const std::string text = absl::StrCat("# a\n", kFour, "f 1 2 3\nf 1 3 4\n");
  for (const char* end : {"\r", "\r\n", "\n\n", "\r\r", "\r\n\r"}) {
    std::string other;
    for (const char c : text) c == '\n' ? other.append(end) : other.append(1, c);
    ExpectTwoTriangles(other);
  }
  std::string mixed = text;
  mixed[mixed.find("\nv 1 0")] = '\r';
  mixed[mixed.find("\nf 1 3")] = '\r';
  ExpectTwoTriangles(mixed);
}

// Text of the note of that kind; empty when there is none.
std::string NoteOf(const MeshFile& mesh, std::string_view kind) {
  for (const InputNote& note : mesh.notes) {
    if (note.kind == kind) return note.text;
  }
  return "";
}

TEST(ObjReaderTest, SmallFacesAreLeftOutCountedAndSaid) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile two,
      DecodeText(absl::StrCat(kFour, "usemtl a\nf 1 2 3\nf 1/1 2\nusemtl b\nf 1 3 4\nf 2 3\n")));
  ASSERT_EQ(two.topology.num_faces(), 2);
  EXPECT_THAT(two.appearance.face_materials, ElementsAre(0, 1));
  EXPECT_EQ(NoteOf(two, "faces_left_out"), "2 faces with 2 corners left out (the first in line 7)");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mixed,
                             DecodeText(absl::StrCat(kFour, "f\nf 1 2 3\nf 1\n")));
  EXPECT_EQ(NoteOf(mixed, "faces_left_out"),
            "2 faces with fewer than 3 corners left out (the first in line 5)");
  // What is left out may still not name vertices that cannot be.
  EXPECT_THAT(DecodeText(absl::StrCat(kFour, "f 1 2 3\nf 0 1\n")), HasStatus(kInvalid, testing::_));
}

TEST(ObjReaderTest, NormalsAndTextureCoordinatesNeverRefuseAFile) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText(
          absl::StrCat(kFour, "vt 0,5 1\nvt 1 1\nf 1/1/0 2/2/0 3/3/-9\nf 1/0/ 3/-7/1 4/-1/8\n")));
  EXPECT_THAT(mesh.appearance.corner_texcoords, ElementsAre(0, 1, -1, -1, -1, 1));
  EXPECT_EQ(mesh.appearance.texcoords[0], Eigen::Vector2f::Zero());
  EXPECT_THAT(NoteOf(mesh, "texcoords_missing"), HasSubstr("missing for 3 corners, ignored"));
  EXPECT_THAT(NoteOf(mesh, "texcoords_unreadable"), HasSubstr("(line 5)"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile none,
                             DecodeText(absl::StrCat(kFour, "f 1/1 2/2 3/3\n")));
  EXPECT_TRUE(none.appearance.corner_texcoords.empty());
}

TEST(ObjReaderTest, WhatIsDroppedIsSaidOnce) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText("o a\nv 0 0 0 1 0 .5\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nvn 0 0 1\ng b\ns 1\nl 1 2\n"
                 "f 1 2 3\ns off\n"));
  EXPECT_EQ(NoteOf(mesh, "not_kept"),
            "not kept: vertex colors, normals (computed where they are needed), 2 groups and "
            "objects, smoothing groups, 1 line or point");
  EXPECT_EQ(mesh.notes.size(), 1u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile plain,
                             DecodeText(absl::StrCat(kFour, "s off\nf 1 2 3\n")));
  EXPECT_TRUE(plain.notes.empty());
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile curves,
      DecodeText(absl::StrCat(kFour, "f 1 2 3\ncstype bezier\ncurv 0 1 1 2\n")));
  EXPECT_FALSE(NoteOf(curves, "surfaces_left_out").empty());
}

TEST(ObjReaderTest, NamesAreUtf8) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodeText(absl::StrCat("mtllib B\xe6r.mtl\n", kFour,
                              "usemtl B\xe6r\nf 1 2 3\nusemtl B\xf8r\nf 1 3 4\n")));
  EXPECT_EQ(mesh.appearance.material_library, "B\xc3\xa6r.mtl");
  EXPECT_THAT(mesh.appearance.material_names, ElementsAre("B\xc3\xa6r", "B\xc3\xb8r"));
  EXPECT_THAT(NoteOf(mesh, "names_not_utf8"), HasSubstr("3 names are not UTF-8"));
}

TEST(ObjReaderTest, FaultsComeWithFileAndLine) {
  const struct {
    const char* text;
    const char* message;
  } kCases[] = {
      {"v 0 0\n", "m.obj:1: a vertex needs three numbers x y z, found the end of the line"},
      {"v 0 0 0\nv 1 2 3,5\n", "m.obj:2: a vertex needs three numbers x y z, found '3,5'"},
      {"v 0 0 1e50\n", "m.obj:1: a vertex needs"},
      {"v 0 0 0 v 1 0 0\n", "m.obj:1: a vertex has three numbers x y z, found 'v' after them"},
      {"v 0 0 0\rv 1 x\r", "m.obj:2: a vertex needs three numbers x y z, found 'x'"},
      {"v \x1b[31m 0 0\n", "found '\\x1b[31m'"},
      {"v 0 0 0\nf 1 2 x\n", "m.obj:2: a face needs vertex numbers, found 'x'"},
      {"v 0 0 0\nf 0 1 1\n", "m.obj:2: vertex numbers start at 1"},
      {"v 0 0 0\nf 1 1 1\nf 1 1 9\nv 0 0 0", "m.obj:3: the face names vertex 9 but the file has 2"},
      {"v 0 0 0\nf -1 -2 -1\n", "m.obj:2: vertex number -2 reaches back beyond the 1"},
      {"v 0 0 0\nf 1/a 1 1\n", "m.obj:2: a face needs texture coordinate numbers, found 'a'"},
      {"v 0 0 0\nf 1.5 1 1\n", "m.obj:2: a face corner is"},
      {"v 0 0 0\nf 99999999999 1 1\n", "m.obj:2: a face needs vertex numbers"},
      {"v 0 0 0\\\n\nv x\n", "m.obj:3: "},
  };
  for (const auto& [text, message] : kCases) {
    EXPECT_THAT(DecodeText(text), HasStatus(kInvalid, HasSubstr(message))) << text;
  }
}

TEST(ObjReaderTest, EmptyAndForeignFilesAreNamed) {
  EXPECT_THAT(DecodeText(""), HasStatus(kInvalid, HasSubstr("m.obj: the file is empty")));
  EXPECT_THAT(DecodeText("<html>not a mesh</html>\n"), HasStatus(kInvalid, HasSubstr("HTML")));
  EXPECT_THAT(DecodeText("# nothing\n"), HasStatus(kInvalid, HasSubstr("the mesh is empty")));
  EXPECT_THAT(DecodeText(kFour), HasStatus(kInvalid, HasSubstr("0 faces")));
}

TEST(ObjReaderTest, NumbersTooSmallForFloatAreZero) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh,
                             DecodeText("v 1e-60 -1e-400 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  EXPECT_EQ(mesh.positions.col(0), Eigen::Vector3f::Zero());
}

TEST(ObjReaderTest, NotANumberIsReadAndLeftToTheSequence) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh,
                             DecodeText("v nan 0 0\nv 1 -inf 0\nv 0 1 -nan(ind)\nf 1 2 3\n"));
  EXPECT_TRUE(std::isnan(mesh.positions(0, 0)));
}

TEST(ObjReaderTest, LimitsAreKept) {
  const std::string text = absl::StrCat(kFour, "f 1 2 3\nf 1 3 4\n");
  EXPECT_THAT(DecodeText(text, {.max_vertices = 3}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit of 3")));
  EXPECT_THAT(DecodeText(text, {.max_faces = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("m.obj:6")));
  EXPECT_THAT(DecodeText(text, {.max_vertices = 4, .max_faces = 2}), IsOk());
}

TEST(ObjReaderTest, DamagedFilesFailCleanlyOrReadAValidMesh) {
  const std::string text = absl::StrCat(
      "mtllib a.mtl\n", kFour, "vt 0 1\nusemtl m\nf 1/1 2/1 -2/-1 4//9\nf 1/1/1 2/1 3/1\n");
  int num_valid = 0;
  const auto decode = [&](const std::string& damaged) {
    const absl::StatusOr<MeshFile> mesh = DecodeText(damaged);
    if (!mesh.ok()) return;
    ++num_valid;
    EXPECT_EQ(mesh->positions.cols(), mesh->topology.num_vertices());
    for (const int32_t corner : mesh->topology.corner_vertices()) {
      EXPECT_LT(corner, mesh->positions.cols());
    }
  };
  ForEachTruncation(text, decode);
  ForEachCorruption(text, decode);
  EXPECT_GT(num_valid, 0);
}

TEST(ObjReaderTest, MissingFileIsNotFound) {
  EXPECT_THAT(ReadObj("/nonexistent/a.obj"),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("/nonexistent/a.obj")));
}

}  // namespace
}  // namespace pleat
