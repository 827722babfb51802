#include "pleat/stream/draco_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "draco/compression/expert_encode.h"
#include "draco_bytes.h"
#include "draco_encode.h"
#include "stream/draco_bytes.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

std::string MeshBytes(const TestMesh& mesh, MeshMethod method) {
  const auto draco = MakeDracoMesh(mesh.topology.num_vertices(), mesh.topology.triangles());
  SetDracoPositions(mesh.positions, {}, draco.get());
  return DracoBytes(EncodeDracoMesh, *draco, TorusBox(), method, 5).value();
}

std::string CloudBytes(const TestMesh& mesh, int method) {
  const auto cloud = MakeDracoPointCloud(static_cast<int>(mesh.positions.cols()));
  SetDracoPositions(mesh.positions, {}, cloud.get());
  draco::ExpertEncoder encoder(*cloud);
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(0, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return std::string(buffer.data(), buffer.size());
}

TEST(DracoFileTest, MeshesComeWithPositionsTrianglesAndVertexNumbers) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  for (const MeshMethod method : {MeshMethod::kEdgebreaker, MeshMethod::kSequential}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const DracoGeometry mesh, DecodeDracoFile(MeshBytes(torus, method)));
    ASSERT_EQ(mesh.positions.cols(), 80);
    ASSERT_EQ(mesh.vertex_numbers.size(), 80u);
    for (int i = 0; i < 80; ++i) {
      const Eigen::Vector3f error =
          mesh.positions.col(i) - torus.positions.col(mesh.vertex_numbers[i]);
      EXPECT_LE(error.cwiseAbs().maxCoeff(), .5 * TorusBox().step_m() + 1e-6) << i;
    }
    // Triangles over vertex numbers, first corner the smallest: as a set they are the mesh's own.
    const auto key = [](int a, int b, int c) {
      std::vector<int> corners{a, b, c};
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      return corners;
    };
    std::vector<std::vector<int>> found, expected;
    for (int f = 0; f < 160; ++f) {
      const Eigen::Vector3i t = mesh.triangles.col(f), own = torus.topology.triangles().col(f);
      found.push_back(
          key(mesh.vertex_numbers[t[0]], mesh.vertex_numbers[t[1]], mesh.vertex_numbers[t[2]]));
      expected.push_back(key(own[0], own[1], own[2]));
    }
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
  }
}

TEST(DracoFileTest, PointCloudsOfBothMethodsHaveNoTriangles) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  for (const int method :
       {draco::POINT_CLOUD_SEQUENTIAL_ENCODING, draco::POINT_CLOUD_KD_TREE_ENCODING}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const DracoGeometry cloud,
                               DecodeDracoFile(CloudBytes(torus, method)));
    EXPECT_EQ(cloud.triangles.cols(), 0);
    EXPECT_TRUE(cloud.vertex_numbers.empty());
    ASSERT_EQ(cloud.positions.cols(), 80);
    // The kd-tree loses the order: every decoded point is near one of the torus.
    for (int i = 0; i < 80; ++i) {
      const float nearest =
          (torus.positions.colwise() - cloud.positions.col(i)).colwise().norm().minCoeff();
      EXPECT_LT(nearest, 1e-3f) << method << " " << i;
    }
  }
}

TEST(DracoFileTest, CountsOverALimitAreToldBeforeAnythingIsDecoded) {
  const TestMesh torus = MakeTorus(10, 8, 2);
  for (const std::string& bytes :
       {MeshBytes(torus, MeshMethod::kEdgebreaker), MeshBytes(torus, MeshMethod::kSequential),
        CloudBytes(torus, draco::POINT_CLOUD_SEQUENTIAL_ENCODING)}) {
    EXPECT_THAT(DecodeDracoFile(bytes, {.max_vertices = 79}),
                HasStatus(absl::StatusCode::kResourceExhausted,
                          testing::AllOf(HasSubstr("80"), HasSubstr("79"))));
    EXPECT_THAT(DecodeDracoFile(bytes, {.max_vertices = 80}), IsOk());
    // The counts stand in the header: a file of nothing else is refused alike.
    EXPECT_THAT(DecodeDracoFile(bytes.substr(0, 20), {.max_vertices = 79}),
                HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
  }
}

TEST(DracoFileTest, WhatIsNoDracoFileIsNamed) {
  EXPECT_THAT(DecodeDracoFile("PLEAT and more bytes"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("no Draco header")));
  EXPECT_THAT(DecodeDracoFile(""),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("Draco magic")));
  std::string old = MeshBytes(MakeTorus(10, 8, 2), MeshMethod::kEdgebreaker);
  old[5] = 1;
  EXPECT_THAT(DecodeDracoFile(old), HasStatus(absl::StatusCode::kDataLoss,
                                              HasSubstr("bitstream 1.2 is too old, encode again")));
  std::string method = MeshBytes(MakeTorus(10, 8, 2), MeshMethod::kEdgebreaker);
  method[8] = 7;
  EXPECT_THAT(DecodeDracoFile(method),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("unknown mesh encoding method")));
}

TEST(DracoFileTest, FilesWithoutPositionsAreRefused) {
  const auto cloud = MakeDracoResidualCloud(20);
  SetDracoResiduals(Eigen::Matrix3Xi::Ones(3, 20), cloud.get());
  EXPECT_THAT(DecodeDracoFile(DracoBytes(EncodeDracoResiduals, *cloud, 5).value()),
              HasStatus(absl::StatusCode::kDataLoss,
                        "malformed Draco frame: no positions of three coordinates"));
}

TEST(DracoFileTest, PositionsOfTruthValuesAreRefusedUnread) {
  draco::PointCloud cloud;
  cloud.set_num_points(2);
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_BOOL, false, 3, 0);
  draco::PointAttribute* positions =
      cloud.attribute(cloud.AddAttribute(attribute, /*identity_mapping=*/true, 2));
  // A byte of 6 is no bool: whoever loads it as one is undefined, which a sanitizer says.
  std::memset(positions->GetAddress(draco::AttributeValueIndex(0)), 6, 6);
  draco::ExpertEncoder encoder(cloud);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  EXPECT_THAT(DecodeDracoFile({buffer.data(), buffer.size()}),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("true or false")));
}

TEST(DracoFileTest, EveryTruncationIsRefused) {
  const TestMesh torus = MakeTorus(6, 5, 2);
  for (const std::string& bytes :
       {MeshBytes(torus, MeshMethod::kEdgebreaker), MeshBytes(torus, MeshMethod::kSequential),
        CloudBytes(torus, draco::POINT_CLOUD_SEQUENTIAL_ENCODING)}) {
    ForEachTruncation(bytes, [](const std::string& cut) {
      EXPECT_FALSE(DecodeDracoFile(cut, {.max_vertices = 100}).ok()) << cut.size();
    });
  }
}

}  // namespace
}  // namespace pleat
