#include "pleat/formats/ply_writer.h"

#include <numeric>

#include "pleat/formats/ply_reader.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

TEST(PlyWriterTest, ReadsBackToTheSameBits) {
  const MeshShape sphere = MakeUvSphere(0.7, 9, 13);
  const Eigen::Matrix3Xf positions = sphere.positions.cast<float>();
  const TemporaryFolder folder;
  ASSERT_THAT(WritePly(folder.File("a.ply"), sphere.topology, positions), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, ReadPly(folder.File("a.ply")));
  EXPECT_EQ(mesh.positions, positions);
  EXPECT_TRUE(mesh.topology == sphere.topology);
  EXPECT_TRUE(mesh.appearance.corner_texcoords.empty());
}

TEST(PlyWriterTest, KeepsTheTexcoordsOfCorners) {
  const MeshShape grid = MakeGrid(2, 1, 1, 1);
  MeshAppearance appearance;
  appearance.texcoords = {{0, 0}, {0.25f, 1}};
  appearance.corner_texcoords = {0, 1, 1, 0, 1, -1, 0, 0};
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodePly(EncodePly(grid.topology, grid.positions.cast<float>(), appearance), "a.ply"));
  for (int corner = 0; corner < 4; ++corner) {
    const int32_t read = mesh.appearance.corner_texcoords[corner];
    ASSERT_GE(read, 0);
    EXPECT_EQ(mesh.appearance.texcoords[read],
              appearance.texcoords[appearance.corner_texcoords[corner]]);
  }
  EXPECT_EQ(mesh.appearance.corner_texcoords[4], -1);  // its face is not complete
}

TEST(PlyWriterTest, LargePolygonsFit) {
  std::vector<int32_t> corners(300);
  std::iota(corners.begin(), corners.end(), 0);
  const Topology topology = *Topology::Create(300, corners, {300});
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshFile mesh,
      DecodePly(EncodePly(topology, Eigen::Matrix3Xf::Random(3, 300)), "a.ply"));
  EXPECT_TRUE(mesh.topology == topology);
}

}  // namespace
}  // namespace pleat
