#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "compressed_format.h"
#include "pleat/base/random.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Every corner has coordinates of its own, shared along the way as an atlas shares them.
MeshAppearance AtlasOf(const Topology& topology) {
  MeshAppearance appearance;
  std::vector<int32_t> of_vertex(topology.num_vertices(), -1);
  for (int i = 0; i < topology.num_corners(); ++i) {
    int32_t& index = of_vertex[topology.corner_vertices()[i]];
    if (index < 0 || i % 5 == 0) {  // a seam
      index = static_cast<int32_t>(appearance.texcoords.size());
      appearance.texcoords.emplace_back(.01f * static_cast<float>(i), -.5f);
    }
    appearance.corner_texcoords.push_back(i % 11 == 0 ? -1 : index);
  }
  appearance.material_names = {"skin", "cloth", "hair"};
  for (int f = 0; f < topology.num_faces(); ++f) {
    appearance.face_materials.push_back(f % 7 == 0 ? -1 : f / 5 % 3);
  }
  return appearance;
}

// The header of a file with this appearance, through its bytes.
CompressedHeader HeaderOf(const MeshAppearance& appearance, const Topology& topology) {
  constexpr size_t kFlags = 32;  // docs/formats/compressed_sequence.md: behind eight counts
  CompressedHeader header;
  header.num_vertices = static_cast<uint32_t>(topology.num_vertices());
  header.num_faces = static_cast<uint32_t>(topology.num_faces());
  header.num_corners = static_cast<uint32_t>(topology.num_corners());
  header.num_frames = 1;
  header.num_texcoords = static_cast<uint32_t>(appearance.texcoords.size());
  header.steps = {1, 1, 1, 1};
  header.segment_frames = {1};
  std::string bytes = EncodeHeader(header);
  bytes[kFlags] = static_cast<char>((appearance.corner_texcoords.empty() ? 0 : 1) |
                                    (appearance.face_materials.empty() ? 0 : 2));
  return DecodeHeader(bytes, {}).value();
}

void ExpectRoundTrip(const MeshAppearance& appearance, const Topology& topology) {
  MeshAppearance decoded;
  decoded.material_names = appearance.material_names;
  ASSERT_THAT(DecodeAppearance(EncodeAppearance(appearance, topology),
                               HeaderOf(appearance, topology), topology, &decoded),
              IsOk());
  ASSERT_EQ(decoded.texcoords.size(), appearance.texcoords.size());
  for (size_t i = 0; i < decoded.texcoords.size(); ++i) {
    for (int c = 0; c < 2; ++c) {  // as bits: NaN and -0 are what the file says
      EXPECT_EQ(std::bit_cast<uint32_t>(decoded.texcoords[i][c]),
                std::bit_cast<uint32_t>(appearance.texcoords[i][c]));
    }
  }
  EXPECT_EQ(decoded.corner_texcoords, appearance.corner_texcoords);
  EXPECT_EQ(decoded.face_materials, appearance.face_materials);
}

TEST(AppearanceCoderTest, EveryPartRoundTripsAloneAndTogether) {
  const Topology topology = MakeTorus(10, 8, 2).topology;
  const MeshAppearance atlas = AtlasOf(topology);
  ExpectRoundTrip(atlas, topology);
  ExpectRoundTrip({}, topology);
  MeshAppearance materials = atlas;
  materials.texcoords.clear();
  materials.corner_texcoords.clear();
  ExpectRoundTrip(materials, topology);
  MeshAppearance coordinates = atlas;
  coordinates.face_materials.clear();
  ExpectRoundTrip(coordinates, topology);
  MeshAppearance unused = atlas;  // coordinates that no corner names
  unused.corner_texcoords.clear();
  ExpectRoundTrip(unused, topology);
}

TEST(AppearanceCoderTest, CoordinatesKeepEveryBit) {
  MeshAppearance appearance;
  for (const float x :
       {-0.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::denorm_min(), 1e30f}) {
    appearance.texcoords.emplace_back(x, -x);
  }
  ExpectRoundTrip(appearance, MakeTorus(3, 3, 1).topology);
}

TEST(AppearanceCoderTest, IndicesInAnyOrderRoundTrip) {
  const Topology topology = MakeTorus(10, 8, 2).topology;
  MeshAppearance appearance = AtlasOf(topology);
  Random random(3);
  for (int32_t& index : appearance.corner_texcoords) {
    index = random.UniformInt(static_cast<int>(appearance.texcoords.size()) + 1) - 1;
  }
  for (int32_t& material : appearance.face_materials) material = random.UniformInt(4) - 1;
  ExpectRoundTrip(appearance, topology);
}

TEST(AppearanceCoderTest, OneAtlasEntryPerVertexCostsAlmostNothingPerCorner) {
  const Topology topology = MakeTorus(40, 30, 2).topology;
  MeshAppearance appearance;
  std::vector<int32_t> of_vertex(topology.num_vertices(), -1);
  for (const int vertex : topology.corner_vertices()) {
    if (of_vertex[vertex] < 0) {
      of_vertex[vertex] = static_cast<int32_t>(appearance.texcoords.size());
      appearance.texcoords.emplace_back(0, 0);
    }
    appearance.corner_texcoords.push_back(of_vertex[vertex]);
  }
  const size_t coordinates = 8 * appearance.texcoords.size();
  const size_t size = EncodeAppearance(appearance, topology).size();
  // Two kinds of corners: at most a bit each.
  EXPECT_LT(size - coordinates, static_cast<size_t>(topology.num_corners()) / 8);
}

TEST(AppearanceCoderTest, MoreCoordinatesThanTheBytesCanHoldAreRefusedWithoutMemory) {
  const Topology topology = MakeTorus(3, 3, 1).topology;
  CompressedHeader header;
  header.num_texcoords = 0xffffffffu;
  MeshAppearance appearance;
  EXPECT_THAT(DecodeAppearance("12345678", header, topology, &appearance),
              HasStatus(absl::StatusCode::kDataLoss, "the appearance is damaged"));
  EXPECT_TRUE(appearance.texcoords.empty());
}

TEST(AppearanceCoderTest, DamagedCodeIsRefusedOrGivesValidIndices) {
  const Topology topology = MakeTorus(6, 5, 2).topology;
  const MeshAppearance appearance = AtlasOf(topology);
  const std::string bytes = EncodeAppearance(appearance, topology);
  int num_refused = 0;
  const auto decode = [&](const std::string& damaged) {
    MeshAppearance decoded;
    decoded.material_names = appearance.material_names;
    if (DecodeAppearance(damaged, HeaderOf(appearance, topology), topology, &decoded).ok()) {
      EXPECT_THAT(CheckAppearance(decoded, topology), IsOk());
    } else {
      ++num_refused;
    }
  };
  for (size_t size = 0; size < bytes.size(); ++size) decode(bytes.substr(0, size));
  // All but the last few cuts are seen.
  EXPECT_GT(num_refused, static_cast<int>(bytes.size()) - 8);
  Random random(5);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = bytes;
    damaged[random.UniformInt(static_cast<int>(bytes.size()))] =
        static_cast<char>(random.NextBits());
    decode(damaged);
  }
}

}  // namespace
}  // namespace pleat
