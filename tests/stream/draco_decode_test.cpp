#include "draco_decode.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "draco_bytes.h"
#include "draco_encode.h"
#include "stream/draco_bytes.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumPoints = 80, kNumTriangles = 160;

const TestMesh& Torus() {
  static const TestMesh torus = MakeTorus(10, 8, 2);
  return torus;
}

std::string MeshBytes(MeshMethod method) {
  const auto mesh = MakeDracoMesh(kNumPoints, Torus().topology.triangles());
  SetDracoPositions(Torus().positions, {}, mesh.get());
  return DracoBytes(EncodeDracoMesh, *mesh, TorusBox(), method, 5).value();
}

std::string CloudBytes() {
  const auto cloud = MakeDracoPointCloud(kNumPoints);
  SetDracoPositions(Torus().positions, {}, cloud.get());
  return DracoBytes(EncodeDracoPointCloud, *cloud, TorusBox(), 5).value();
}

Eigen::Matrix3Xi SomeResiduals() {
  Eigen::Matrix3Xi residuals(3, kNumPoints);
  for (int i = 0; i < kNumPoints; ++i) residuals.col(i) << i % 7 - 3, -(i % 2), i;
  return residuals;
}

std::string ResidualBytes() {
  const auto cloud = MakeDracoResidualCloud(kNumPoints);
  SetDracoResiduals(SomeResiduals(), cloud.get());
  return DracoBytes(EncodeDracoResiduals, *cloud, 5).value();
}

struct DecodedMesh {
  Eigen::Matrix3Xf positions;
  std::vector<int32_t> point_vertices;
  Eigen::Matrix3Xi triangles;
};

absl::Status DecodeMesh(std::string_view bytes, DecodedMesh* mesh, int num_points = kNumPoints,
                        int num_triangles = kNumTriangles, int num_vertices = kNumPoints) {
  return DecodeDracoMesh(bytes, num_points, num_triangles, num_vertices, &mesh->positions,
                         &mesh->point_vertices, &mesh->triangles);
}

TEST(DracoDecodeTest, MeshesComeBackInBothMethods) {
  for (const MeshMethod method : {MeshMethod::kEdgebreaker, MeshMethod::kSequential}) {
    DecodedMesh mesh;
    ASSERT_THAT(DecodeMesh(MeshBytes(method), &mesh), IsOk());
    std::vector<int32_t> sorted = mesh.point_vertices;
    std::sort(sorted.begin(), sorted.end());
    for (int v = 0; v < kNumPoints; ++v) EXPECT_EQ(sorted[v], v);
    for (int p = 0; p < kNumPoints; ++p) {
      const Eigen::Vector3f error =
          mesh.positions.col(p) - Torus().positions.col(mesh.point_vertices[p]);
      EXPECT_LE(error.cwiseAbs().maxCoeff(), .5 * TorusBox().step_m() + 1e-6);
    }
    ASSERT_EQ(mesh.triangles.cols(), kNumTriangles);
    EXPECT_GE(mesh.triangles.minCoeff(), 0);
    EXPECT_LT(mesh.triangles.maxCoeff(), kNumPoints);
  }
}

TEST(DracoDecodeTest, ResidualsComeBackExactly) {
  Eigen::Matrix3Xi residuals;
  ASSERT_THAT(DecodeDracoResiduals(ResidualBytes(), kNumPoints, &residuals), IsOk());
  EXPECT_EQ(residuals, SomeResiduals());
}

TEST(DracoDecodeTest, CountsOtherThanDeclaredAreToldWithBothNumbers) {
  DecodedMesh mesh;
  const std::string sequential = MeshBytes(MeshMethod::kSequential);
  EXPECT_THAT(DecodeMesh(sequential, &mesh, 81), HasStatus(absl::StatusCode::kDataLoss,
                                                           "malformed Draco frame: 80 points, the "
                                                           "stream declared 81"));
  EXPECT_THAT(DecodeMesh(sequential, &mesh, kNumPoints, 159),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("160 triangles, the stream "
                                                               "declared 159")));
  const std::string edgebreaker = MeshBytes(MeshMethod::kEdgebreaker);
  EXPECT_THAT(DecodeMesh(edgebreaker, &mesh, 79),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("too many vertices")));
  EXPECT_FALSE(DecodeMesh(edgebreaker, &mesh, 81).ok());
  Eigen::Matrix3Xf positions;
  EXPECT_THAT(DecodeDracoPointCloud(CloudBytes(), 81, &positions),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("80 points, the stream declared "
                                                               "81")));
}

TEST(DracoDecodeTest, VertexNumbersBeyondTheCharacterAreRefused) {
  for (const MeshMethod method : {MeshMethod::kEdgebreaker, MeshMethod::kSequential}) {
    DecodedMesh mesh;
    EXPECT_THAT(DecodeMesh(MeshBytes(method), &mesh, kNumPoints, kNumTriangles, kNumPoints - 1),
                HasStatus(absl::StatusCode::kDataLoss, HasSubstr("a vertex number out of range")));
  }
}

TEST(DracoDecodeTest, AnotherKindOfGeometryIsRefused) {
  DecodedMesh mesh;
  Eigen::Matrix3Xf positions;
  Eigen::Matrix3Xi residuals;
  EXPECT_THAT(DecodeMesh(CloudBytes(), &mesh),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("not the geometry type")));
  EXPECT_THAT(DecodeDracoPointCloud(MeshBytes(MeshMethod::kSequential), kNumPoints, &positions),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("not the geometry type")));
  // Both are clouds, only the attributes differ.
  EXPECT_THAT(DecodeDracoPointCloud(ResidualBytes(), kNumPoints, &positions),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("malformed Draco frame")));
  EXPECT_THAT(DecodeDracoResiduals(CloudBytes(), kNumPoints, &residuals),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("malformed Draco frame")));
}

TEST(DracoDecodeTest, HeadersOfOtherVersionsMethodsAndFlagsAreNamed) {
  Eigen::Matrix3Xf positions;
  const auto status_with = [&](size_t offset, char value) {
    std::string bytes = CloudBytes();
    bytes[offset] = value;
    return DecodeDracoPointCloud(bytes, kNumPoints, &positions);
  };
  EXPECT_THAT(status_with(0, 'd'),
              HasStatus(absl::StatusCode::kDataLoss, "malformed Draco frame: no Draco header"));
  EXPECT_THAT(status_with(5, 3),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("bitstream 3.3 is newer")));
  EXPECT_THAT(status_with(6, 9),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("bitstream 2.9 is newer")));
  EXPECT_THAT(status_with(8, 1),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("not a sequential point cloud")));
  EXPECT_THAT(status_with(10, '\x80'),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("metadata is not part")));
  EXPECT_THAT(status_with(14, '\xff'),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("a negative number of points")));
}

// The grid stands in the last bytes: its origin can be made infinite without any other damage.
TEST(DracoDecodeTest, PositionsThatAreNotFiniteAreRefused) {
  std::string bytes = CloudBytes();
  const float origin = TorusBox().origin_m[1];
  const std::string needle(reinterpret_cast<const char*>(&origin), sizeof(origin));
  const size_t at = bytes.rfind(needle);
  ASSERT_NE(at, std::string::npos);
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(bytes.data() + at, &infinity, sizeof(infinity));
  Eigen::Matrix3Xf positions;
  EXPECT_THAT(DecodeDracoPointCloud(bytes, kNumPoints, &positions),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("a position that is not finite")));
}

TEST(DracoDecodeTest, EveryTruncationIsRefused) {
  DecodedMesh mesh;
  Eigen::Matrix3Xi residuals;
  for (const MeshMethod method : {MeshMethod::kEdgebreaker, MeshMethod::kSequential}) {
    ForEachTruncation(MeshBytes(method), [&](const std::string& cut) {
      EXPECT_THAT(DecodeMesh(cut, &mesh), HasStatus(absl::StatusCode::kDataLoss, testing::_))
          << cut.size();
    });
  }
  // What stands behind the end of some codes Draco takes as zeros: the frame's checksum sees it
  // (docs/formats/frame_stream.md). The number of points is right all the same.
  int num_accepted = 0;
  const std::string bytes = ResidualBytes();
  ForEachTruncation(bytes, [&](const std::string& cut) {
    if (!DecodeDracoResiduals(cut, kNumPoints, &residuals).ok()) return;
    ++num_accepted;
    EXPECT_EQ(residuals.cols(), kNumPoints);
  });
  EXPECT_LT(num_accepted, static_cast<int>(bytes.size()) / 2);
}

TEST(DracoDecodeTest, CorruptedResidualsAreRefusedOrHaveEveryPoint) {
  ForEachCorruption(ResidualBytes(), [](const std::string& damaged) {
    Eigen::Matrix3Xi residuals;
    if (DecodeDracoResiduals(damaged, kNumPoints, &residuals).ok()) {
      EXPECT_EQ(residuals.cols(), kNumPoints);
    }
  });
}

}  // namespace
}  // namespace pleat
