#include "glb_buffers.h"

#include "glb_container.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(GlbBuffersTest, WhatIsAddedIsReadBackByItsAccessor) {
  GlbBuffers buffers(100);
  const size_t shorts =
      buffers.Add(std::vector<uint16_t>{1, 2, 3, 65535}, "VEC4", 4, kVertexBuffer);
  const size_t integers =
      buffers.Add(std::vector<uint32_t>{7, 1u << 31}, "SCALAR", 1, kIndexBuffer);
  Eigen::Matrix3Xf points(3, 2);
  points << 1, -2, 3, 4, 5, 6;
  const size_t places = buffers.AddPoints(points);
  const size_t normals = buffers.AddVectors(points);
  const size_t times = buffers.Add(std::vector<float>{0, .5f}, "SCALAR", 1, kNoBufferTarget);
  buffers.SetRange(times, 0, .5);
  std::string binary;
  const std::string start = buffers.Finish({{"asset", {{"version", "2.0"}}}}, &binary);
  const std::string bytes = start + binary;
  EXPECT_EQ(bytes.size() % 4, 0u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbContainer glb, GlbContainer::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor joints, glb.Access(shorts, "VEC4"));
  EXPECT_EQ(joints.At(0, 3), 65535);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor indices, glb.Access(integers, "SCALAR"));
  EXPECT_EQ(indices.At(1, 0), 2147483648.);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbAccessor read, glb.Access(places, "VEC3"));
  ASSERT_EQ(read.count(), 2u);
  EXPECT_EQ(read.At(1, 2), 6);
  const nlohmann::json& accessors = glb.List("accessors");
  EXPECT_EQ(accessors[places]["min"], (std::vector<float>{-2, 3, 5}));
  EXPECT_EQ(accessors[places]["max"], (std::vector<float>{1, 4, 6}));
  EXPECT_FALSE(accessors[normals].contains("min"));
  EXPECT_EQ(accessors[times]["max"], (std::vector<double>{.5}));
  const nlohmann::json& views = glb.List("bufferViews");
  EXPECT_EQ(views[shorts]["target"], kVertexBuffer);
  EXPECT_FALSE(views[times].contains("target"));
}

}  // namespace
}  // namespace pleat
