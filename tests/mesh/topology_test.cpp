#include "pleat/mesh/topology.h"

#include <cstdint>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(TopologyTest, KeepsPolygonsAndFansThem) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology topology,
                             Topology::Create(6, {0, 1, 2, 3, 5, 4, 3, 2, 1}, {4, 5}));
  EXPECT_EQ(topology.num_faces(), 2);
  EXPECT_EQ(topology.num_corners(), 9);
  EXPECT_EQ(topology.face_start(1), 4);
  EXPECT_THAT(topology.face(1), ElementsAre(5, 4, 3, 2, 1));
  Eigen::Matrix3Xi expected(3, 5);
  expected << 0, 0, 5, 5, 5,  //
      1, 2, 4, 3, 2,          //
      2, 3, 3, 2, 1;
  EXPECT_EQ(topology.triangles(), expected);
}

TEST(TopologyTest, NamesTheFirstBadFace) {
  EXPECT_THAT(Topology::Create(3, {0, 1, 2, 0, 1}, {3, 2}),
              HasStatus(kInvalid, HasSubstr("face 1")));
  EXPECT_THAT(Topology::Create(3, {0, 1, 2, 0, 1, 3}, {3, 3}),
              HasStatus(kInvalid, testing::AllOf(HasSubstr("face 1"), HasSubstr("vertex 3"))));
  EXPECT_THAT(Topology::Create(3, {0, -1, 2}, {3}), HasStatus(kInvalid, HasSubstr("vertex -1")));
  EXPECT_THAT(Topology::Create(0, {}, {}), HasStatus(kInvalid, HasSubstr("at least one vertex")));
}

TEST(TopologyTest, CornerCountsMustAddUp) {
  EXPECT_FALSE(Topology::Create(3, {0, 1, 2}, {3, 3}).ok());
  EXPECT_FALSE(Topology::Create(3, {0, 1, 2, 0}, {3}).ok());
  // Sizes whose sum would overflow 32 bits.
  EXPECT_FALSE(Topology::Create(3, {0, 1, 2}, {0x7fffffff, 0x7fffffff, 5}).ok());
}

TEST(TopologyTest, EqualityIsThatOfPolygonsNotOfTriangles) {
  const Topology quad = *Topology::Create(4, {0, 1, 2, 3}, {4});
  const Topology pair = *Topology::Create(4, {0, 1, 2, 0, 2, 3}, {3, 3});
  EXPECT_EQ(quad.triangles(), pair.triangles());
  EXPECT_FALSE(quad == pair);
  EXPECT_TRUE(pair == *Topology::FromTriangles(4, pair.triangles()));
}

TEST(TopologyTest, FacesNeedThreeCornersAndMeshesAVertex) {
  for (const int32_t size : {2, 1, 0, -1, INT32_MIN}) {
    EXPECT_THAT(Topology::Create(3, {0, 1}, {size}), HasStatus(kInvalid, HasSubstr("face 0 has")))
        << size;
  }
  EXPECT_FALSE(Topology::Create(-1, {}, {}).ok());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology cloud, Topology::Create(7, {}, {}));
  EXPECT_EQ(cloud.num_faces(), 0);
  EXPECT_EQ(cloud.num_triangles(), 0);
}

TEST(TopologyTest, AppearanceNamesWhatIsThere) {
  const Topology quad = *Topology::Create(4, {0, 1, 2, 3}, {4});
  const MeshAppearance good{.texcoords = {{0, 0}, {1, 1}},
                            .corner_texcoords = {0, 1, -1, 1},
                            .material_names = {"cloth"},
                            .face_materials = {0},
                            .material_library = {}};
  EXPECT_THAT(CheckAppearance(good, quad), IsOk());
  EXPECT_THAT(CheckAppearance({}, quad), IsOk());
  const auto refused = [&](auto spoil, const char* words) {
    MeshAppearance bad = good;
    spoil(bad);
    EXPECT_THAT(CheckAppearance(bad, quad), HasStatus(kInvalid, HasSubstr(words)));
  };
  refused([](MeshAppearance& a) { a.corner_texcoords[2] = 2; }, "entry 2 is 2");
  refused([](MeshAppearance& a) { a.corner_texcoords[3] = -2; }, "entry 3 is -2");
  refused([](MeshAppearance& a) { a.corner_texcoords.pop_back(); }, "there are 3");
  refused([](MeshAppearance& a) { a.face_materials[0] = 1; }, "face materials");
  refused([](MeshAppearance& a) { a.material_names.clear(); }, "face materials");
}

}  // namespace
}  // namespace pleat
