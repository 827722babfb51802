#include "draco_encode.h"

#include <gtest/gtest.h>

#include "draco/compression/decode.h"
#include "draco_bytes.h"
#include "pleat/base/random.h"
#include "stream/draco_bytes.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

constexpr int kBits = 14;

// Draco's own decoder, unguarded: what any other reader makes of the bytes.
std::unique_ptr<draco::PointCloud> DecodeWithDraco(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto cloud = decoder.DecodePointCloudFromBuffer(&buffer);
  EXPECT_TRUE(cloud.ok()) << cloud.status().error_msg_string();
  EXPECT_EQ(buffer.remaining_size(), 0);
  return cloud.ok() ? std::move(cloud).value() : std::make_unique<draco::PointCloud>();
}

template <int kRows, typename Scalar>
Eigen::Matrix<Scalar, kRows, 1> ValueOf(const draco::PointCloud& cloud, int attribute, int point) {
  Eigen::Matrix<Scalar, kRows, 1> value;
  const draco::PointAttribute& values = *cloud.attribute(attribute);
  values.GetValue(values.mapped_index(draco::PointIndex(static_cast<uint32_t>(point))),
                  value.data());
  return value;
}

TEST(DracoEncodeTest, MeshesKeepPositionsNumbersAndTrianglesInBothMethods) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  const auto mesh = MakeDracoMesh(torus.topology.num_vertices(), torus.topology.triangles());
  SetDracoPositions(torus.positions, {}, mesh.get());
  for (const MeshMethod method : {MeshMethod::kEdgebreaker, MeshMethod::kSequential}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               DracoBytes(EncodeDracoMesh, *mesh, TorusBox(kBits), method, 5));
    EXPECT_EQ(bytes.substr(0, 5), "DRACO");
    EXPECT_EQ(bytes[7], 1);  // a mesh
    EXPECT_EQ(bytes[8], method == MeshMethod::kEdgebreaker ? 1 : 0);
    const auto decoded = DecodeWithDraco(bytes);
    ASSERT_EQ(decoded->num_attributes(), 2);
    ASSERT_EQ(decoded->num_points(), 80u);
    std::vector<int> seen(80, 0);
    for (int p = 0; p < 80; ++p) {
      const int vertex = ValueOf<1, int32_t>(*decoded, 1, p)[0];
      ASSERT_TRUE(vertex >= 0 && vertex < 80);
      ++seen[vertex];
      const Eigen::Vector3f error = ValueOf<3, float>(*decoded, 0, p) - torus.positions.col(vertex);
      EXPECT_LE(error.cwiseAbs().maxCoeff(), .5 * TorusBox(kBits).step_m() + 1e-6);
    }
    EXPECT_THAT(seen, testing::Each(1));
  }
}

TEST(DracoEncodeTest, CloudsKeepTheGivenOrder) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  std::vector<int32_t> order(80);
  for (int k = 0; k < 80; ++k) order[k] = (k * 7 + 3) % 80;
  const auto cloud = MakeDracoPointCloud(80);
  SetDracoPositions(torus.positions, order, cloud.get());
  for (const int speed : {0, 5, 10}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               DracoBytes(EncodeDracoPointCloud, *cloud, TorusBox(kBits), speed));
    EXPECT_EQ(bytes[8], 0) << "the kd-tree loses the order";
    const auto decoded = DecodeWithDraco(bytes);
    ASSERT_EQ(decoded->num_points(), 80u);
    for (int k = 0; k < 80; ++k) {
      const Eigen::Vector3f error =
          ValueOf<3, float>(*decoded, 0, k) - torus.positions.col(order[k]);
      EXPECT_LE(error.cwiseAbs().maxCoeff(), .5 * TorusBox(kBits).step_m() + 1e-6) << k;
    }
  }
}

TEST(DracoEncodeTest, SettingPositionsAgainOverwritesTheLastFrame) {
  const auto cloud = MakeDracoPointCloud(3);
  SetDracoPositions(Eigen::Matrix3Xf::Constant(3, 3, .5f), {}, cloud.get());
  Eigen::Matrix3Xf second(3, 3);
  second << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  SetDracoPositions(second, {2, 0, 1}, cloud.get());
  EXPECT_EQ((ValueOf<3, float>(*cloud, 0, 0)), Eigen::Vector3f(3, 6, 9));
  EXPECT_EQ((ValueOf<3, float>(*cloud, 0, 1)), Eigen::Vector3f(1, 4, 7));
  EXPECT_EQ((ValueOf<3, float>(*cloud, 0, 2)), Eigen::Vector3f(2, 5, 8));
}

TEST(DracoEncodeTest, ResidualsAreExactUpToTheLargestThatDracoCodes) {
  Random random(4);
  for (const int spread : {0, 1, 100, 1 << 20}) {
    Eigen::Matrix3Xi residuals(3, 200);
    for (int& r : residuals.reshaped()) r = random.UniformInt(2 * spread + 1) - spread;
    const auto cloud = MakeDracoResidualCloud(200);
    SetDracoResiduals(residuals, cloud.get());
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               DracoBytes(EncodeDracoResiduals, *cloud, 5));
    const auto decoded = DecodeWithDraco(bytes);
    ASSERT_EQ(decoded->num_attributes(), 3);
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < 200; ++i) {
        ASSERT_EQ((ValueOf<1, int32_t>(*decoded, c, i)[0]), residuals(c, i)) << spread;
      }
    }
  }
}

// The largest that a difference of two frames can leave: Draco throws on some values, and nobody
// outside may see an exception.
TEST(DracoEncodeTest, WhatDracoCannotCodeIsAnErrorOrRoundTrips) {
  Eigen::Matrix3Xi residuals = Eigen::Matrix3Xi::Zero(3, 50);
  residuals(0, 7) = -(1 << 27);
  residuals(1, 9) = 1 << 27;
  const auto cloud = MakeDracoResidualCloud(50);
  SetDracoResiduals(residuals, cloud.get());
  const absl::StatusOr<std::string> bytes = DracoBytes(EncodeDracoResiduals, *cloud, 5);
  if (!bytes.ok()) {
    EXPECT_THAT(bytes, HasStatus(absl::StatusCode::kInternal,
                                 testing::StartsWith("Draco cannot encode: ")));
    return;
  }
  const auto decoded = DecodeWithDraco(*bytes);
  EXPECT_EQ((ValueOf<1, int32_t>(*decoded, 0, 7)[0]), residuals(0, 7));
  EXPECT_EQ((ValueOf<1, int32_t>(*decoded, 1, 9)[0]), residuals(1, 9));
}

TEST(DracoEncodeTest, TheSameInputGivesTheSameBytes) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  std::string first;
  for (int round = 0; round < 2; ++round) {
    const auto mesh = MakeDracoMesh(torus.topology.num_vertices(), torus.topology.triangles());
    SetDracoPositions(torus.positions, {}, mesh.get());
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const std::string bytes,
        DracoBytes(EncodeDracoMesh, *mesh, TorusBox(kBits), MeshMethod::kEdgebreaker, 5));
    if (round == 0) first = bytes;
    EXPECT_EQ(bytes, first);
  }
}

}  // namespace
}  // namespace pleat
