#include "pleat/formats/alembic_writer.h"

#include <string>

#include "alembic_archive.h"
#include "formats/alembic_scene.h"
#include "pleat/formats/alembic_reader.h"
#include "pleat/formats/sequence_file.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::ElementsAre;

// A box whose corners move, in `order`: frames that repeat are equal.
MeshSequence MovingBox(const std::vector<int>& order, MeshSequenceOptions options = {}) {
  const MeshShape box = MakeBox({1, 2, 3});
  std::vector<Eigen::Matrix3Xf> frames;
  for (const int t : order) {
    Eigen::Matrix3Xf frame = box.positions.cast<float>();
    frame.row(1).array() += 0.3f * static_cast<float>(t);
    frames.push_back(frame);
  }
  return MeshSequence::Create(box.topology, std::move(frames), std::move(options)).value();
}

// Everything of two sequences is equal: the canonical bytes are.
void ExpectComesBack(const MeshSequence& sequence) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshSequence read,
      DecodeAlembic(EncodeAlembic(sequence), "a.abc", {.name = sequence.name()}));
  EXPECT_EQ(EncodeSequence(read), EncodeSequence(sequence));
}

TEST(AlembicWriterTest, SequencesComeBack) {
  ExpectComesBack(MovingBox({0}, {.name = "one"}));
  ExpectComesBack(MovingBox({0, 1, 2, 3}, {.name = "some", .frame_rate = {30000, 1001}}));
  ExpectComesBack(MovingBox({0, 0, 0}, {.frame_rate = {24, 1}}));
  ExpectComesBack(MovingBox({0, 0, 1, 2, 1, 1, 2, 2}, {.frame_rate = {4115, 226}}));
}

TEST(AlembicWriterTest, TexcoordsAndMaterialsComeBack) {
  MeshAppearance appearance;
  appearance.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int f = 0; f < 6; ++f) {
    for (const int32_t i : {0, 1, 2, 3}) appearance.corner_texcoords.push_back((i + f) % 4);
  }
  appearance.material_names = {"skin", "cloth"};
  appearance.face_materials = {0, 0, 1, 1, -1, 0};
  ExpectComesBack(MovingBox({0, 1}, {.name = "painted", .appearance = appearance}));
}

TEST(AlembicWriterTest, CornersWithoutTexcoordsGetZero) {
  MeshAppearance appearance;
  appearance.texcoords = {{0.5f, 0.5f}};
  appearance.corner_texcoords.assign(24, -1);
  appearance.corner_texcoords[3] = 0;
  const std::string bytes = EncodeAlembic(MovingBox({0}, {.appearance = appearance}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence read, DecodeAlembic(bytes, "a.abc"));
  const MeshAppearance& back = read.appearance();
  EXPECT_EQ(back.texcoords[back.corner_texcoords[3]], Eigen::Vector2f(0.5f, 0.5f));
  EXPECT_EQ(back.texcoords[back.corner_texcoords[4]], Eigen::Vector2f(0, 0));
}

TEST(AlembicWriterTest, FramesThatRepeatTakeNoPlace) {
  const size_t once = EncodeAlembic(MovingBox({0, 1, 2})).size();
  const size_t often = EncodeAlembic(MovingBox({0, 1, 2, 2, 2, 2, 2, 2, 2, 2})).size();
  EXPECT_LE(often, once + 8);
  // Between changes only references are written, 8 bytes each: two for P, one for the box.
  const size_t between = EncodeAlembic(MovingBox({0, 1, 1, 1, 1, 2})).size();
  EXPECT_EQ(between, once + 3 * 3 * 8);
}

std::vector<std::string> PathsOf(const std::string& bytes) {
  const absl::StatusOr<AlembicArchive> archive = AlembicArchive::Open(bytes);
  EXPECT_THAT(archive, IsOk());
  std::vector<std::string> paths;
  for (size_t i = 1; archive.ok() && i < archive->objects().size(); ++i) {
    paths.push_back(archive->Path(static_cast<int>(i)));
  }
  return paths;
}

TEST(AlembicWriterTest, NamesAreFitForPaths) {
  MeshAppearance appearance;
  appearance.material_names = {"a/b", "a_b", "", "unused"};
  appearance.face_materials = {0, 1, 2, 0, 1, 2};
  const std::string bytes =
      EncodeAlembic(MovingBox({0}, {.name = "walk/1", .appearance = appearance}));
  EXPECT_THAT(PathsOf(bytes),
              ElementsAre("/walk_1", "/walk_1/walk_1Shape", "/walk_1/walk_1Shape/a_b",
                          "/walk_1/walk_1Shape/a_b_2", "/walk_1/walk_1Shape/material"));
  EXPECT_THAT(PathsOf(EncodeAlembic(MovingBox({0}))), ElementsAre("/mesh", "/mesh/meshShape"));
  const std::string long_name(9000, 'n');
  EXPECT_THAT(PathsOf(EncodeAlembic(MovingBox({0}, {.name = long_name}))), testing::SizeIs(2));
}

TEST(AlembicWriterTest, FilesAreWritten) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteAlembic(folder.File("a.abc"), MovingBox({0, 1})), IsOk());
  EXPECT_FALSE(WriteAlembic("/dev/null/a.abc", MovingBox({0})).ok());
}

}  // namespace
}  // namespace pleat
