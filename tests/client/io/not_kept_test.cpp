#include "cli/io/not_kept.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/test_sequence.h"
#include "support/mesh_shapes.h"

namespace pleat {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(NotKept, ArchivesOfArraysHoldEverything) {
  EXPECT_THAT(NotKept(AnimationFormat::kNpz, MovingTetrahedron(2), 7), IsEmpty());
  EXPECT_THAT(NotKept(AnimationFormat::kGlb, MovingTetrahedron(2), 0), IsEmpty());
}

TEST(NotKept, PolygonsTimesAndMaterialsAreNamed) {
  const MeshShape box = MakeBox({1, 1, 1});
  MeshSequenceOptions options;
  options.appearance.material_names = {"skin"};
  options.appearance.face_materials.assign(6, 0);
  options.appearance.material_library = "skin.mtl";
  const MeshSequence sequence =
      *MeshSequence::Create(box.topology, {box.positions.cast<float>()}, options);
  EXPECT_THAT(NotKept(AnimationFormat::kGlb, sequence, 3),
              testing::ElementsAre(HasSubstr("first frame"), HasSubstr("polygons"),
                                   HasSubstr("material library")));
  EXPECT_THAT(NotKept(AnimationFormat::kPly, sequence, 0), Contains("materials"));
  EXPECT_THAT(NotKept(AnimationFormat::kPc2, sequence, 3), testing::ElementsAre("the frame rate"));
  EXPECT_THAT(NotKept(AnimationFormat::kDraco, sequence, 0), Contains(HasSubstr("grid")));
}

TEST(NotKept, FormatsKnowWhatTheySay) {
  EXPECT_TRUE(SaysFrameRate(AnimationFormat::kMdd));
  EXPECT_FALSE(SaysFrameRate(AnimationFormat::kObj));
  EXPECT_TRUE(SaysSpace(AnimationFormat::kUsda));
  EXPECT_FALSE(SaysSpace(AnimationFormat::kAbc));
}

}  // namespace
}  // namespace pleat
