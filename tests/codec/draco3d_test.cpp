// Every payload of a stream read by the npm package draco3d (what browsers use) under node.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

#include "codec/test_meshes.h"
#include "draco/compression/decode.h"
#include "pleat/base/file.h"
#include "pleat/codec/frame_encoder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

// What `command` prints; empty when it fails.
std::string Output(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  std::array<char, 4096> buffer;
  while (pipe != nullptr && fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    output += buffer.data();
  }
  return output;
}

// The line that delta_stream_node.js prints, from Draco's own decoder.
std::string Expected(const std::string& name, const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto cloud = decoder.DecodePointCloudFromBuffer(&buffer).value();
  double sum = 0;
  for (int a = 0; a < cloud->num_attributes(); ++a) {
    const draco::PointAttribute& attribute = *cloud->attribute(a);
    int place = 0;
    for (uint32_t p = 0; p < cloud->num_points(); ++p) {
      std::array<float, 4> values{};
      attribute.ConvertValue<float>(attribute.mapped_index(draco::PointIndex(p)),
                                    attribute.num_components(), values.data());
      for (int c = 0; c < attribute.num_components(); ++c) sum += (place++ % 97 + 1) * values[c];
    }
  }
  std::array<char, 100> line;
  std::snprintf(line.data(), line.size(), "%s %u %d %.3f\n", name.c_str(), cloud->num_points(),
                cloud->num_attributes(), sum);
  return line.data();
}

TEST(Draco3dTest, NodeReadsEveryPayload) {
  if (Output("node -e \"require('draco3d'); console.log('found')\" 2>/dev/null") != "found\n") {
    GTEST_SKIP() << "node with the package draco3d is not on this machine (NODE_PATH)";
  }
  const TestMesh mesh = MakeTorus(24, 12, 3);
  const TemporaryFolder folder;
  std::string expected;
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    FrameEncoder encoder =
        FrameEncoder::Create(mesh.topology, mesh.positions, {.encoding = encoding}).value();
    for (int t = 0; t < 3; ++t) {
      const std::string name =
          (encoding == FrameEncoding::kDracoDelta ? "delta" : "cloud") + std::to_string(t) + ".drc";
      const std::string bytes = encoder.Encode(Bend(mesh.positions, t)).value();
      ASSERT_THAT(WriteFile(folder.File(name), bytes), IsOk());
      expected += Expected(name, bytes);
    }
  }
  EXPECT_EQ(Output("node " PLEAT_SOURCE_DIR "/tests/codec/delta_stream_node.js " + folder.File("")),
            expected);
}

}  // namespace
}  // namespace pleat
