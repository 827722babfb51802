#include "alembic_mesh.h"

#include <string>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// An archive with one mesh, as far as it can be read.
struct MeshArchive {
  std::string bytes;
  absl::StatusOr<AlembicArchive> archive = absl::UnknownError("");
  absl::StatusOr<AlembicMesh> mesh = absl::UnknownError("");
  int num_vertices = 0;

  explicit MeshArchive(SceneMesh scene) {
    AlembicBuilder builder;
    const ObjectToWrite object = MeshObject(&builder, std::move(scene));
    bytes = builder.Finish({object}, "");
    archive = AlembicArchive::Open(bytes);
    if (archive.ok()) mesh = ReadAlembicMesh(1, &*archive);
    if (mesh.ok()) num_vertices = CountVertices(*mesh, {}, &*archive).value_or(0);
  }

  absl::StatusOr<AlembicFaces> Faces(const MeshLimits& limits = {}) {
    return ReadFaces(*mesh, num_vertices, limits, &*archive);
  }
  absl::Status Same() {
    return CheckSameTopology(*mesh, num_vertices, mesh->num_samples(), &*archive);
  }
};

TEST(AlembicMeshTest, FacesAreTurned) {
  MeshArchive archive(
      {.frames = {Square(0)}, .counts = {{4, 3}}, .indices = {{0, 1, 2, 3, 2, 0, 1}}});
  ASSERT_THAT(archive.mesh, IsOk());
  EXPECT_TRUE(IsAlembicMesh(*archive.archive, 1));
  EXPECT_FALSE(IsAlembicMesh(*archive.archive, 0));
  EXPECT_EQ(archive.num_vertices, 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicFaces faces, archive.Faces());
  EXPECT_THAT(faces.corner_vertices, ElementsAre(3, 2, 1, 0, 1, 0, 2));
  EXPECT_THAT(faces.corner_sources, ElementsAre(3, 2, 1, 0, 6, 5, 4));
  EXPECT_THAT(faces.face_sizes, ElementsAre(4, 3));
}

TEST(AlembicMeshTest, FacesOfFewerThanThreeCornersAreLeftOut) {
  MeshArchive archive(
      {.frames = {Square(0)}, .counts = {{2, 3, 0, 1}}, .indices = {{0, 1, 0, 1, 2, 3}}});
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicFaces faces, archive.Faces());
  EXPECT_THAT(faces.corner_vertices, ElementsAre(2, 1, 0));
  EXPECT_THAT(faces.face_sources, ElementsAre(1));
  EXPECT_EQ(faces.num_file_faces, 4);
  EXPECT_EQ(faces.num_file_corners, 6);
}

TEST(AlembicMeshTest, FacesThatDoNotFitAreRefused) {
  const auto faces = [](std::vector<int32_t> counts, std::vector<int32_t> indices) {
    MeshArchive archive({.frames = {Square(0)}, .counts = {counts}, .indices = {indices}});
    return archive.Faces().status();
  };
  EXPECT_THAT(faces({4}, {0, 1, 2}), HasStatus(kInvalid, HasSubstr("3 are left")));
  EXPECT_THAT(faces({3, 3}, {0, 1, 2}), HasStatus(kInvalid, HasSubstr("face 1 declares 3")));
  EXPECT_THAT(faces({3}, {0, 1, 2, 3}), HasStatus(kInvalid, HasSubstr("have 3 corners")));
  EXPECT_THAT(faces({-1}, {0, 1, 2}), HasStatus(kInvalid, HasSubstr("face 0 declares -1")));
  EXPECT_THAT(faces({0x7fffffff}, {0, 1, 2}), HasStatus(kInvalid, HasSubstr("2147483647")));
  EXPECT_THAT(faces({3}, {0, 1, 4}), HasStatus(kInvalid, HasSubstr("vertex 4 of 4")));
  EXPECT_THAT(faces({3}, {0, -1, 2}), HasStatus(kInvalid, HasSubstr("vertex -1")));
  MeshArchive many({.frames = {Square(0)}, .counts = {{3, 3}}, .indices = {{0, 1, 2, 0, 1, 2}}});
  EXPECT_THAT(many.Faces({.max_faces = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("2 faces")));
}

TEST(AlembicMeshTest, WhatIsMissingIsNamed) {
  EXPECT_THAT(MeshArchive({.frames = {}}).mesh, HasStatus(kInvalid, HasSubstr("no 'P'")));
  EXPECT_THAT(MeshArchive({.frames = {Square(0)}, .counts = {}}).mesh,
              HasStatus(kInvalid, HasSubstr("no '.faceCounts'")));
  MeshArchive empty({.frames = {{}}, .counts = {{}}, .indices = {{}}});
  EXPECT_THAT(CountVertices(*empty.mesh, {}, &*empty.archive),
              HasStatus(kInvalid, HasSubstr("no vertices")));
  MeshArchive large({.frames = {Square(0)}});
  EXPECT_THAT(CountVertices(*large.mesh, {.max_vertices = 3}, &*large.archive),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("4 vertices")));
}

TEST(AlembicMeshTest, ChangesOfTheTopologyAreNamedByTheirFrame) {
  const std::vector<int32_t> quad = {0, 1, 2, 3}, other = {0, 2, 1, 3};
  std::vector<float> fewer = Square(0);
  fewer.resize(9);
  // The same faces again, in a sample of their own, are no change.
  EXPECT_THAT(MeshArchive({.frames = {Square(0), Square(1), Square(2)}}).Same(), IsOk());
  EXPECT_THAT(
      MeshArchive({.frames = {Square(0), Square(1), Square(2)}, .indices = {quad, quad, other}})
          .Same(),
      HasStatus(kInvalid, HasSubstr("frame 2 has other faces")));
  EXPECT_THAT(
      MeshArchive({.frames = {Square(0), fewer, Square(2)}, .indices = {quad, quad, other}}).Same(),
      HasStatus(kInvalid, HasSubstr("frame 1 has another number of vertices")));
  EXPECT_THAT(MeshArchive({.frames = {Square(0)}, .counts = {{4}, {4}, {4}, {3, 1}}}).Same(),
              HasStatus(kInvalid, HasSubstr("frame 3 has other faces")));
}

TEST(AlembicMeshTest, PositionsAreTransformedOrCopied) {
  const float smallest = 1.4e-45f;
  MeshArchive archive(
      {.frames = {{-0.0f, smallest, 3e38f, 1, 2, 3}}, .counts = {{}}, .indices = {{}}});
  ASSERT_EQ(archive.num_vertices, 2);
  Eigen::Matrix3Xf positions(3, 2);
  Eigen::Matrix4d rows = Eigen::Matrix4d::Identity();
  ASSERT_THAT(ReadPositions(*archive.mesh, 0, rows, &*archive.archive, positions), IsOk());
  EXPECT_TRUE(std::signbit(positions(0, 0)));
  EXPECT_EQ(positions(1, 0), smallest);
  EXPECT_EQ(positions(2, 0), 3e38f);
  rows.row(3) << 10, 20, 30, 1;  // the translation
  rows(0, 0) = 2;
  ASSERT_THAT(ReadPositions(*archive.mesh, 0, rows, &*archive.archive, positions), IsOk());
  EXPECT_EQ(positions.col(1), Eigen::Vector3f(12, 22, 33));
}

TEST(AlembicMeshTest, DoublesAreRounded) {
  AlembicBuilder builder;
  SceneMesh scene = {.frames = {Square(0)}};
  ObjectToWrite object = MeshObject(&builder, scene);
  object.properties[0].properties[0] = ArrayProperty<double>(
      &builder, "P", AlembicType::kFloat64, 3, {{0.1, 0.2, 0.3, 1, 0, 0, 1, 1, 0, 0, 1, 0}});
  const std::string bytes = builder.Finish({object}, "");
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicMesh mesh, ReadAlembicMesh(1, &archive));
  PLEAT_ASSERT_OK_AND_ASSIGN(const int num_vertices, CountVertices(mesh, {}, &archive));
  Eigen::Matrix3Xf positions(3, num_vertices);
  ASSERT_THAT(ReadPositions(mesh, 0, Eigen::Matrix4d::Identity(), &archive, positions), IsOk());
  EXPECT_EQ(positions.col(0), Eigen::Vector3f(0.1f, 0.2f, 0.3f));
}

}  // namespace
}  // namespace pleat
