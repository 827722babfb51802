#include "pleat/formats/obj_writer.h"

#include "formats/obj_folder.h"
#include "pleat/base/random.h"
#include "pleat/formats/obj_reader.h"
#include "pleat/formats/sequence_reader.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

TEST(ObjWriterTest, NumbersReadBackToTheSameBits) {
  const MeshShape sphere = MakeUvSphere(0.7, 9, 13);
  Random random(5);
  Eigen::Matrix3Xf positions = sphere.positions.cast<float>();
  for (float& entry : positions.reshaped()) {
    entry *= static_cast<float>(std::pow(10, random.Uniform(-30, 30)));
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh,
                             DecodeObj(EncodeObj(sphere.topology, positions), "x.obj"));
  EXPECT_EQ(mesh.positions, positions);
  EXPECT_TRUE(mesh.topology == sphere.topology);
}

TEST(ObjWriterTest, AppearanceRoundTrips) {
  const std::string text =
      "mtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 1\nvt 0 0\n"
      "usemtl skin\nf 1/1 2/2 3/1 4\nusemtl cloth\nf 1/2 3 4\nusemtl skin\nf 2 3 4\n";
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, DecodeObj(text, "x.obj"));
  EXPECT_EQ(EncodeObj(mesh.topology, mesh.positions, mesh.appearance), text);
}

TEST(ObjWriterTest, SequenceFolderReadsBack) {
  const MeshShape box = MakeBox({1, 2, 3});
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < 12; ++t) frames.push_back(box.positions.cast<float>() * (1 + 0.1f * t));
  const MeshSequence sequence = *MeshSequence::Create(box.topology, frames);
  const TemporaryFolder folder;
  ASSERT_THAT(WriteObjFolder(folder.File("out"), sequence), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence read, ReadSequence(folder.File("out")));
  ASSERT_EQ(read.num_frames(), 12);
  for (int t = 0; t < 12; ++t) EXPECT_EQ(read.frame(t), sequence.frame(t));
}

}  // namespace
}  // namespace pleat
