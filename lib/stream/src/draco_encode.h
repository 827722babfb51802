// The encoding half of the Draco library, as functions on plain arrays. `bytes` keep their memory,
// but Draco itself allocates for every frame. The functions named Make build a geometry once; those
// named Set overwrite its values for each frame.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "draco/mesh/mesh.h"
#include "draco/point_cloud/point_cloud.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

enum class MeshMethod { kEdgebreaker, kSequential };

// Makes a mesh with float positions (attribute 0) and the int32 vertex numbers 0..V-1 (attribute
// 1). triangles: 3 x F.
std::unique_ptr<draco::Mesh> MakeDracoMesh(int num_vertices, const Eigen::Matrix3Xi& triangles);
// Makes a point cloud with float positions (attribute 0).
std::unique_ptr<draco::PointCloud> MakeDracoPointCloud(int num_points);

// Overwrites the positions (attribute 0): point k becomes column order[k] of `positions`, or column
// k when `order` is empty.
void SetDracoPositions(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                       const std::vector<int32_t>& order, draco::PointCloud* cloud);

// Makes a point cloud with three int32 attributes of one component each (0, 1, 2: x, y, z). Apart,
// they decode in half the time that one attribute with three components takes.
std::unique_ptr<draco::PointCloud> MakeDracoResidualCloud(int num_points);
void SetDracoResiduals(const Eigen::Matrix3Xi& residuals, draco::PointCloud* cloud);
absl::Status EncodeDracoResiduals(const draco::PointCloud& cloud, int speed, std::string* bytes);

absl::Status EncodeDracoMesh(const draco::Mesh& mesh, const QuantizationBox& box, MeshMethod method,
                             int speed, std::string* bytes);
absl::Status EncodeDracoPointCloud(const draco::PointCloud& cloud, const QuantizationBox& box,
                                   int speed, std::string* bytes);

}  // namespace pleat
