#include "pleat/formats/glb_writer.h"

#include <cmath>
#include <cstring>

#include "formats/painted_box.h"
#include "glb_container.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

// Through a file and back.
absl::StatusOr<MeshSequence> ThroughGlb(const MeshSequence& sequence, InputReport* report) {
  const TemporaryFolder folder;
  const absl::Status written = WriteGlb(folder.File("a.glb"), sequence);
  if (!written.ok()) return written;
  return ReadSequence(folder.File("a.glb"), {}, {}, report);
}

TEST(GlbWriterTest, PositionsComeBackBitByBitInTheirOrder) {
  // Coordinates that pass zero, where the sum of mesh and target loses the last bits.
  std::vector<Eigen::Matrix3Xf> frames;
  const MeshSequence box = PaintedBox(1, true);
  for (int t = 0; t < 400; ++t) {
    Eigen::Matrix3Xf frame = box.frame(0);
    for (Eigen::Index i = 0; i < frame.size(); ++i) {
      frame.data()[i] = std::sin(1.7f * static_cast<float>(t + 3 * i)) *
                        (t % 2 == 0 ? std::exp(-static_cast<float>((t * 7 + i) % 12)) : 1.f);
    }
    if (t == 5) frame(1, 1) = -0.f;
    frames.push_back(frame);
  }
  const MeshSequence sequence =
      *MeshSequence::Create(box.topology(), std::move(frames),
                            {.frame_rate = {4115, 226}, .appearance = box.appearance()});
  InputReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, ThroughGlb(sequence, &report));
  ASSERT_EQ(back.num_frames(), 400);
  ASSERT_EQ(back.num_vertices(), sequence.num_vertices());
  for (int t = 0; t < 400; ++t) {
    EXPECT_EQ(std::memcmp(back.frame(t).data(), sequence.frame(t).data(),
                          static_cast<size_t>(back.frame(t).size()) * 4),
              0)
        << t;
  }
  EXPECT_EQ(back.frame_rate(), sequence.frame_rate());
  EXPECT_TRUE(report.has_frame_rate);
  EXPECT_TRUE(report.notes.empty());
}

TEST(GlbWriterTest, TrianglesMaterialsAndTexcoordsComeBack) {
  const MeshSequence sequence = PaintedBox(3, true);
  InputReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, ThroughGlb(sequence, &report));
  // Faces of one material follow each other here, so their order stays.
  EXPECT_EQ(back.topology().triangles(), sequence.topology().triangles());
  EXPECT_EQ(back.appearance().material_names, sequence.appearance().material_names);
  const MeshAppearance& before = sequence.appearance();
  const MeshAppearance& after = back.appearance();
  for (int c = 0; c < 6; ++c) {  // the two triangles in front
    EXPECT_LT(
        (after.texcoords[after.corner_texcoords[c]] - before.texcoords[before.corner_texcoords[c]])
            .norm(),
        1e-7);
  }
}

TEST(GlbWriterTest, OneFrameHasNoAnimation) {
  const MeshSequence sequence = PaintedBox(1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeGlb(sequence));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  EXPECT_TRUE(glb.List("animations").empty());
  EXPECT_EQ(bytes.size() % 4, 0u);
}

TEST(GlbWriterTest, TheFileIsWhatOtherProgramsExpect) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeGlb(PaintedBox(3)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  const nlohmann::json& mesh = glb.List("meshes")[0];
  EXPECT_EQ(mesh["weights"], nlohmann::json({0, 0}));
  EXPECT_EQ(mesh["primitives"].size(), 2u);  // a material each
  EXPECT_EQ(mesh["primitives"][0]["targets"].size(), 2u);
  const nlohmann::json& animation = glb.List("animations")[0];
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor weights,
                             glb.Access(animation["samplers"][0]["output"], "SCALAR"));
  EXPECT_EQ(weights.CopyFloats(), (std::vector<float>{0, 0, 1, 0, 0, 1}));
  for (const nlohmann::json& accessor : glb.List("accessors")) {
    EXPECT_TRUE(accessor["type"] != "VEC3" || accessor.contains("min"));
  }
}

}  // namespace
}  // namespace pleat
