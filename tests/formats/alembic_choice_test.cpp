#include "alembic_choice.h"

#include <string>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// What is chosen from an archive, by path.
struct Chosen {
  absl::Status status;
  std::vector<std::string> paths;
  int num_frames = 0;
  std::vector<InputNote> notes;
};

Chosen Choose(const std::string& bytes, const std::string& object = "",
              const MeshLimits& limits = {}) {
  Chosen chosen;
  absl::StatusOr<AlembicArchive> archive = AlembicArchive::Open(bytes);
  EXPECT_THAT(archive, IsOk());
  const auto choice = ChooseAlembicMeshes(object, limits, &*archive, &chosen.notes);
  chosen.status = choice.status();
  if (!choice.ok()) return chosen;
  for (const PlacedMesh& mesh : choice->meshes) {
    chosen.paths.push_back(archive->Path(mesh.mesh.object));
  }
  chosen.num_frames = choice->times.num_samples;
  return chosen;
}

// /walker (moves) with /walker/body (deforms) and /walker/hat (moved), /floor (still), and
// /late/ball, which deforms at other times.
std::string Stage(bool with_ball) {
  AlembicBuilder builder;
  const uint32_t frames = builder.AddTimeSampling(Uniform(24));
  const uint32_t late = builder.AddTimeSampling(Uniform(24, 1));
  SceneXform walker = {.name = "walker",
                       .operations = {0x10},
                       .samples = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                       .sampling = frames};
  walker.children = {
      MeshObject(&builder,
                 {.name = "body", .frames = {Square(0), Square(1), Square(2)}, .sampling = frames}),
      MeshObject(&builder, {.name = "hat", .frames = {Square(9)}})};
  std::vector<ObjectToWrite> top = {
      XformObject(&builder, walker),
      MeshObject(&builder, {.name = "floor", .frames = {Square(-1)}})};
  if (with_ball) {
    top.push_back(XformObject(
        &builder, {.name = "late",
                   .children = {MeshObject(&builder, {.name = "ball",
                                                      .frames = {Square(5), Square(6), Square(7)},
                                                      .sampling = late})}}));
  }
  return builder.Finish(top, "");
}

TEST(AlembicChoiceTest, MeshesThatMoveAreJoined) {
  const Chosen chosen = Choose(Stage(false));
  ASSERT_THAT(chosen.status, IsOk());
  EXPECT_THAT(chosen.paths, ElementsAre("/walker/body", "/walker/hat"));
  EXPECT_EQ(chosen.num_frames, 3);
  ASSERT_EQ(chosen.notes.size(), 1u);
  EXPECT_EQ(chosen.notes[0].kind, "objects_left_out");
  EXPECT_THAT(chosen.notes[0].text, HasSubstr("/floor"));
  EXPECT_TRUE(IsRefusedWhenStrict(chosen.notes[0]));
}

TEST(AlembicChoiceTest, ObjectsAreChosenByPath) {
  EXPECT_THAT(Choose(Stage(true), "/floor").paths, ElementsAre("/floor"));
  EXPECT_THAT(Choose(Stage(true), "/late/ball").paths, ElementsAre("/late/ball"));
  EXPECT_THAT(Choose(Stage(true), "/late").paths, ElementsAre("/late/ball"));
  EXPECT_THAT(Choose(Stage(false), "/").paths,
              ElementsAre("/walker/body", "/walker/hat", "/floor"));
  EXPECT_THAT(Choose(Stage(true), "/walker/hat").notes, IsEmpty());
  EXPECT_EQ(Choose(Stage(true), "/walker/hat").num_frames, 3);
  EXPECT_EQ(Choose(Stage(true), "/floor").num_frames, 1);
}

TEST(AlembicChoiceTest, OtherTimesAreListed) {
  EXPECT_THAT(
      Choose(Stage(true)).status,
      HasStatus(kInvalid, AllOf(HasSubstr("/walker/body (3 samples from 0"),
                                HasSubstr("/late/ball (3 samples from 1"), HasSubstr("--object"))));
}

TEST(AlembicChoiceTest, WhatIsNotThereIsAnsweredWithWhatIs) {
  constexpr auto kNotFound = absl::StatusCode::kNotFound;
  EXPECT_THAT(Choose(Stage(false), "/walker/shoe").status,
              HasStatus(kNotFound, AllOf(HasSubstr("no object '/walker/shoe'"),
                                         HasSubstr("/walker/body, /walker/hat, /floor"))));
  AlembicBuilder curves;
  const std::string bytes =
      curves.Finish({{.name = "hair", .metadata = "schema=AbcGeom_Curve_v2"}}, "");
  EXPECT_THAT(Choose(bytes).status,
              HasStatus(kNotFound, AllOf(HasSubstr("no mesh"), HasSubstr("AbcGeom_Curve_v2"))));
  AlembicBuilder mixed;
  const std::string with_mesh =
      mixed.Finish({{.name = "hair", .metadata = "schema=AbcGeom_Curve_v2"},
                    MeshObject(&mixed, {.name = "m", .frames = {Square(0)}})},
                   "");
  EXPECT_THAT(Choose(with_mesh, "/hair").status,
              HasStatus(kNotFound, AllOf(HasSubstr("at or below"), HasSubstr("/m"))));
}

TEST(AlembicChoiceTest, EmptyMeshesAreLeftOutUnlessNothingElseIsThere) {
  AlembicBuilder builder;
  const ObjectToWrite empty =
      MeshObject(&builder, {.name = "empty", .frames = {{}}, .counts = {{}}, .indices = {{}}});
  const ObjectToWrite full = MeshObject(&builder, {.name = "full", .frames = {Square(0)}});
  const Chosen chosen = Choose(builder.Finish({empty, full}, ""));
  EXPECT_THAT(chosen.paths, ElementsAre("/full"));
  EXPECT_THAT(chosen.notes[0].text, HasSubstr("/empty"));
  AlembicBuilder alone;
  const std::string only_empty = alone.Finish(
      {MeshObject(&alone, {.name = "empty", .frames = {{}}, .counts = {{}}, .indices = {{}}})}, "");
  EXPECT_THAT(Choose(only_empty).status,
              HasStatus(kInvalid, HasSubstr("'/empty': the mesh has no vertices")));
}

TEST(AlembicChoiceTest, InstancesAreCounted) {
  AlembicBuilder builder;
  const std::string bytes =
      builder.Finish({MeshObject(&builder, {.frames = {Square(0)}}),
                      {.name = "again", .metadata = "isInstance=1;schema=AbcGeom_PolyMesh_v1"}},
                     "");
  const Chosen chosen = Choose(bytes);
  ASSERT_EQ(chosen.notes.size(), 1u);
  EXPECT_EQ(chosen.notes[0].kind, "instances_left_out");
}

TEST(AlembicChoiceTest, ATransformThatInheritsNothingHidesThoseAbove) {
  AlembicBuilder builder;
  SceneXform outer = {.name = "outer", .operations = {0x10}, .samples = {{0, 0, 0}, {1, 0, 0}}};
  SceneXform inner = {.name = "inner", .inherits = {{0}}};
  inner.children = {MeshObject(&builder, {.name = "still", .frames = {Square(0)}})};
  outer.children = {XformObject(&builder, inner)};
  const std::string bytes = builder.Finish({XformObject(&builder, outer)}, "");
  EXPECT_EQ(Choose(bytes).num_frames, 1);
}

TEST(AlembicChoiceTest, TheNumberOfFramesIsLimited) {
  EXPECT_THAT(Choose(Stage(false), "", {.max_frames = 2}).status,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit of 2 frames")));
}

}  // namespace
}  // namespace pleat
