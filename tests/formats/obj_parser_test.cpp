#include "obj_parser.h"

#include "absl/strings/str_cat.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr char kVertices[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n";
constexpr char kFaces[] = "f 1/1 2 3\nusemtl m\nf -1 -2/9 -4\nf 1 2\n";

absl::StatusOr<ObjFrame> Parse(const std::string& text, const ObjFaceText* known = nullptr,
                               ObjFaceText* faces = nullptr) {
  static const MeshLimits& limits = *new MeshLimits;
  static const std::string& file = *new std::string("m.obj");
  return ParseObj(text, file, limits, known, faces);
}

TEST(ObjParserTest, KnownFacesAreRecognizedAndSayTheSame) {
  ObjFaceText faces;
  PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame first,
                             Parse(absl::StrCat(kVertices, kFaces), nullptr, &faces));
  EXPECT_FALSE(first.has_known_faces);
  EXPECT_EQ(faces.text, kFaces);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const ObjFrame second,
      Parse(absl::StrCat("# frame 2\nv 9 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt .5 x\n", kFaces),
            &faces));
  EXPECT_TRUE(second.has_known_faces);
  EXPECT_EQ(second.mesh.positions.col(0), Eigen::Vector3f(9, 0, 0));
  ASSERT_EQ(second.mesh.notes.size(), first.mesh.notes.size());
  for (size_t i = 0; i < first.mesh.notes.size(); ++i) {
    EXPECT_EQ(second.mesh.notes[i].kind, first.mesh.notes[i].kind);
  }
}

// The texture coordinates of later frames are not read, but where their statements end is seen.
TEST(ObjParserTest, JoinedLinesAreNoStatementsInLaterFramesEither) {
  ObjFaceText faces;
  const std::string text = absl::StrCat(kVertices, "vt 1 \\\nv 5 5 5\n", kFaces);
  PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame first, Parse(text, nullptr, &faces));
  EXPECT_EQ(first.mesh.positions.cols(), 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame second, Parse(text, &faces));
  EXPECT_TRUE(second.has_known_faces);
  EXPECT_EQ(second.mesh.positions, first.mesh.positions);
}

TEST(ObjParserTest, FacesThatMayMeanSomethingElseAreParsedAgain) {
  ObjFaceText faces;
  ASSERT_THAT(Parse(absl::StrCat(kVertices, kFaces), nullptr, &faces), IsOk());
  for (const std::string& other :
       {absl::StrCat("v 5 5 5\n", kVertices, kFaces),  // relative indices mean others
        absl::StrCat("vt 1 1\n", kVertices, kFaces),   // the same of texture coordinates
        absl::StrCat(kVertices, kFaces, "f 1 3 4\n"), absl::StrCat(kVertices, "f 1 2 3\n")}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame frame, Parse(other, &faces));
    EXPECT_FALSE(frame.has_known_faces) << other;
    PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame alone, Parse(other));
    EXPECT_TRUE(frame.mesh.topology == alone.mesh.topology);
  }
}

TEST(ObjParserTest, FacesBeforeTheLastVertexCannotBeKnown) {
  ObjFaceText faces;
  PLEAT_ASSERT_OK_AND_ASSIGN(const ObjFrame frame,
                             Parse("v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n", nullptr, &faces));
  EXPECT_EQ(frame.mesh.positions.cols(), 3);
  EXPECT_TRUE(faces.text.empty());
}

// Whatever is damaged: what is recognized has the positions that a full parse gives.
TEST(ObjParserTest, DamagedFramesAreReadAlikeWithAndWithoutKnownFaces) {
  const std::string text = absl::StrCat(kVertices, kFaces);
  ObjFaceText faces;
  ASSERT_THAT(Parse(text, nullptr, &faces), IsOk());
  int num_known = 0;
  ForEachCorruption(text, [&](const std::string& damaged) {
    const absl::StatusOr<ObjFrame> known = Parse(damaged, &faces), alone = Parse(damaged);
    ASSERT_EQ(known.ok(), alone.ok()) << damaged;
    if (!known.ok()) return;
    num_known += known->has_known_faces;
    ASSERT_EQ(known->mesh.positions.cols(), alone->mesh.positions.cols());
    for (Eigen::Index i = 0; i < known->mesh.positions.size(); ++i) {
      const float a = known->mesh.positions(i), b = alone->mesh.positions(i);
      EXPECT_TRUE(a == b || (a != a && b != b)) << damaged;
    }
  });
  EXPECT_GT(num_known, 10);
}

}  // namespace
}  // namespace pleat
