#include "alembic_appearance.h"

#include <limits>
#include <string>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Appearance {
  MeshAppearance appearance;
  std::vector<InputNote> notes;

  std::string NoteOf(const std::string& kind) const {
    for (const InputNote& note : notes) {
      if (note.kind == kind) return note.text;
    }
    return "";
  }
};

// Reads the appearance of a square of two triangles: corners 0 1 2 and 0 2 3 in the file.
Appearance ReadTwoTriangles(AlembicBuilder* builder, SceneMesh scene) {
  scene.frames = {Square(0)};
  scene.counts = {{3, 3}};
  scene.indices = {{0, 1, 2, 0, 2, 3}};
  const ObjectToWrite object = MeshObject(builder, std::move(scene));
  const std::string bytes = builder->Finish({object}, "");
  Appearance result;
  absl::StatusOr<AlembicArchive> archive = AlembicArchive::Open(bytes);
  EXPECT_THAT(archive, IsOk());
  const auto mesh = ReadAlembicMesh(1, &*archive);
  EXPECT_THAT(mesh, IsOk());
  const auto faces = ReadFaces(*mesh, 4, {}, &*archive);
  EXPECT_THAT(faces, IsOk());
  const auto appearance = ReadAlembicAppearance(*mesh, *faces, 4, &*archive, &result.notes);
  EXPECT_THAT(appearance, IsOk());
  if (appearance.ok()) result.appearance = *appearance;
  return result;
}

PropertyToWrite Uv(AlembicBuilder* builder, const std::vector<float>& values,
                   const std::string& scope) {
  PropertyToWrite uv = ArrayProperty<float>(builder, "uv", AlembicType::kFloat32, 2, {values});
  if (!scope.empty()) uv.metadata = "geoScope=" + scope;
  return uv;
}

PropertyToWrite IndexedUv(AlembicBuilder* builder, const std::vector<float>& values,
                          const std::vector<std::vector<uint32_t>>& indices) {
  PropertyToWrite uv = {.name = "uv", .metadata = "geoScope=fvr"};
  uv.properties.push_back(
      ArrayProperty<float>(builder, ".vals", AlembicType::kFloat32, 2, {values}));
  uv.properties.push_back(ArrayProperty(builder, ".indices", AlembicType::kUint32, 1, indices));
  return uv;
}

TEST(AlembicAppearanceTest, TexcoordsOfCornersAreTurnedWithTheFaces) {
  AlembicBuilder builder;
  const Appearance result = ReadTwoTriangles(
      &builder, {.more = {IndexedUv(&builder, {0, 0, 1, 0, 1, 1}, {{0, 1, 2, 2, 1, 0}})}});
  EXPECT_THAT(result.appearance.corner_texcoords, ElementsAre(2, 1, 0, 0, 1, 2));
  ASSERT_EQ(result.appearance.texcoords.size(), 3u);
  EXPECT_EQ(result.appearance.texcoords[2], Eigen::Vector2f(1, 1));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(AlembicAppearanceTest, WithoutIndicesEveryCornerHasItsOwn) {
  AlembicBuilder builder;
  const Appearance result = ReadTwoTriangles(
      &builder, {.more = {Uv(&builder, {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5}, "fvr")}});
  EXPECT_THAT(result.appearance.corner_texcoords, ElementsAre(2, 1, 0, 5, 4, 3));
}

TEST(AlembicAppearanceTest, TexcoordsMayBelongToVertices) {
  for (const char* scope : {"vtx", "var", ""}) {
    AlembicBuilder builder;
    const Appearance result =
        ReadTwoTriangles(&builder, {.more = {Uv(&builder, {0, 0, 1, 1, 2, 2, 3, 3}, scope)}});
    EXPECT_THAT(result.appearance.corner_texcoords, ElementsAre(2, 1, 0, 3, 2, 0)) << scope;
  }
}

TEST(AlembicAppearanceTest, TexcoordsThatDoNotFitAreLeftOutWithANote) {
  const auto note = [](AlembicBuilder* builder, PropertyToWrite uv) {
    const Appearance result = ReadTwoTriangles(builder, {.more = {std::move(uv)}});
    EXPECT_THAT(result.appearance.corner_texcoords, IsEmpty());
    EXPECT_THAT(result.appearance.texcoords, IsEmpty());
    return result.NoteOf("texcoords_unreadable");
  };
  AlembicBuilder few, beyond, doubles;
  EXPECT_THAT(note(&few, Uv(&few, {0, 0, 1, 1}, "fvr")), HasSubstr("its 2 texture coordinates"));
  EXPECT_THAT(note(&beyond, IndexedUv(&beyond, {0, 0}, {{0, 0, 0, 0, 0, 1}})),
              HasSubstr("name values that are not there"));
  EXPECT_THAT(note(&doubles, ArrayProperty<double>(&doubles, "uv", AlembicType::kFloat64, 2,
                                                   {{0, 0, 1, 1, 2, 2, 3, 3}})),
              HasSubstr("float32[2]"));
}

TEST(AlembicAppearanceTest, TexcoordsThatAreNoNumbersAreMended) {
  AlembicBuilder builder;
  const float bad = std::numeric_limits<float>::quiet_NaN();
  const Appearance result =
      ReadTwoTriangles(&builder, {.more = {Uv(&builder, {bad, 7, 1, 1, 2, 2, 3, 3}, "vtx")}});
  ASSERT_EQ(result.appearance.texcoords.size(), 4u);
  EXPECT_EQ(result.appearance.texcoords[0], Eigen::Vector2f(0, 0));
  EXPECT_THAT(result.NoteOf("texcoords_unreadable"), HasSubstr("become 0 0"));
}

TEST(AlembicAppearanceTest, FaceSetsAreMaterials) {
  AlembicBuilder builder;
  const Appearance result =
      ReadTwoTriangles(&builder, {.children = {FaceSetObject(&builder, "unused", {{7, -1}}),
                                               FaceSetObject(&builder, "skin", {{1}}),
                                               FaceSetObject(&builder, "cloth", {{0, 1}}),
                                               {.name = "no face set"}}});
  EXPECT_THAT(result.appearance.material_names, ElementsAre("skin", "cloth"));
  EXPECT_THAT(result.appearance.face_materials, ElementsAre(1, 0));
}

TEST(AlembicAppearanceTest, WhatChangesOrIsNotKeptIsSaid) {
  AlembicBuilder builder;
  PropertyToWrite colors = {.name = ".arbGeomParams"};
  colors.properties.push_back(
      ArrayProperty<float>(&builder, "Cs", AlembicType::kFloat32, 3, {{1, 1, 1}}));
  const Appearance result = ReadTwoTriangles(
      &builder,
      {.schema = std::string(kSubdivisionSchema),
       .more = {
           IndexedUv(&builder, {0, 0, 1, 1}, {{0, 0, 0, 0, 0, 0}, {1, 1, 1, 1, 1, 1}}),
           ArrayProperty<float>(&builder, ".velocities", AlembicType::kFloat32, 3, {{1, 2, 3}}),
           colors,
           {.name = ".userProperties"}}});
  EXPECT_THAT(result.NoteOf("appearance_first_frame"), HasSubstr("frame 0"));
  EXPECT_THAT(result.NoteOf("not_kept"), HasSubstr(".velocities, .arbGeomParams"));
  EXPECT_THAT(result.NoteOf("not_kept"), Not(HasSubstr("userProperties")));
  EXPECT_THAT(result.NoteOf("control_mesh"), HasSubstr("subdivision"));
}

}  // namespace
}  // namespace pleat
