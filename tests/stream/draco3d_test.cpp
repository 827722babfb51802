// Every payload of a stream read by what browsers use, under node: the npm package draco3d, and
// three.js's DRACOLoader (package three). Skipped where they are not: `npm install draco3d three`
// in any folder and NODE_PATH=that folder/node_modules.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

#include "draco/compression/decode.h"
#include "pleat/base/file.h"
#include "pleat/stream/frame_encoder.h"
#include "support/programs.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

// The line that the scripts print, from Draco's own decoder.
std::string Expected(const std::string& name, const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  std::unique_ptr<draco::PointCloud> geometry = decoder.DecodePointCloudFromBuffer(&buffer).value();
  double sum = 0;
  for (int a = 0; a < geometry->num_attributes(); ++a) {
    const draco::PointAttribute& attribute = *geometry->attribute(a);
    int place = 0;
    for (uint32_t p = 0; p < geometry->num_points(); ++p) {
      std::array<float, 4> values{};
      attribute.ConvertValue<float>(attribute.mapped_index(draco::PointIndex(p)),
                                    attribute.num_components(), values.data());
      for (int c = 0; c < attribute.num_components(); ++c) sum += (place++ % 97 + 1) * values[c];
    }
  }
  const auto* mesh = dynamic_cast<const draco::Mesh*>(geometry.get());
  const uint32_t num_faces = mesh == nullptr ? 0 : mesh->num_faces();
  for (uint32_t i = 0; i < 3 * num_faces; ++i) {
    sum += (i % 97 + 1) * mesh->face(draco::FaceIndex(i / 3))[i % 3].value();
  }
  std::array<char, 200> line;
  std::snprintf(line.data(), line.size(), "%s %u %d %u %.3f\n", name.c_str(),
                geometry->num_points(), geometry->num_attributes(), num_faces, sum);
  return line.data();
}

// Writes the payloads of all encodings into a folder, in the order of their names, which end in the
// types of the attributes.
class Payloads {
 public:
  Payloads() {
    const TestMesh mesh = MakeTorus(24, 12, 3);
    AddStream("cloud", mesh, FrameEncoding::kDracoPointCloud);
    AddControlStream("control", MakeTorus(8, 6, 3));
    AddStream("delta", mesh, FrameEncoding::kDracoDelta);
    AddStream("mesh", mesh, FrameEncoding::kDracoMesh);
  }
  std::string folder() const { return folder_.File(""); }
  const std::string& expected() const { return expected_; }

 private:
  void AddStream(const std::string& name, const TestMesh& mesh, FrameEncoding encoding) {
    AddFrames(name, mesh,
              FrameEncoder::Create(mesh.topology, mesh.positions, {.encoding = encoding}).value());
  }
  // `mesh` as the control mesh of a character of twice its vertices.
  void AddControlStream(const std::string& name, const TestMesh& mesh) {
    std::vector<int32_t> vertices(mesh.positions.cols());
    for (size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<int32_t>(2 * i);
    const FrameEncoderOptions options{.encoding = FrameEncoding::kDracoDelta,
                                      .content = StreamContent::kControlMesh};
    AddFrames(name, mesh,
              FrameEncoder::Create(mesh.topology, mesh.positions, options, vertices).value());
  }
  void AddFrames(const std::string& name, const TestMesh& mesh, FrameEncoder encoder) {
    for (int t = 0; t < 3; ++t) {
      const std::string bytes = encoder.Encode(Bend(mesh.positions, t)).value();
      const std::string types = encoder.header().encoding == FrameEncoding::kDracoMesh ? "fi"
                                : encoder.mark().keyframe                              ? "f"
                                                                                       : "iii";
      Add(name + std::to_string(t) + "." + types, bytes);
    }
    Add(name + "_topology.fi", encoder.header().topology);
  }
  void Add(const std::string& name, const std::string& bytes) {
    ASSERT_THAT(WriteFile(folder_.File(name + ".drc"), bytes), IsOk());
    expected_ += Expected(name + ".drc", bytes);
  }

  TemporaryFolder folder_;
  std::string expected_;
};

TEST(Draco3dTest, NodeReadsEveryPayload) {
  if (!HasNodePackage("draco3d")) {
    GTEST_SKIP() << "node with the package draco3d is not on this machine (NODE_PATH)";
  }
  const Payloads payloads;
  EXPECT_EQ(OutputOf("node " + InSourceFolder("tests/stream/draco3d.js ") + payloads.folder()),
            payloads.expected());
}

TEST(Draco3dTest, ThreeJsReadsEveryPayload) {
  if (!HasNodePackage("three")) {
    GTEST_SKIP() << "node with the package three is not on this machine (NODE_PATH)";
  }
  const Payloads payloads;
  EXPECT_EQ(OutputOf("node " + InSourceFolder("tests/stream/dracoloader.mjs ") + payloads.folder()),
            payloads.expected());
}

}  // namespace
}  // namespace pleat
