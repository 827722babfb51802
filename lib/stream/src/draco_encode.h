// The encoding half of the Draco library, as functions on plain arrays. `bytes` keep their memory;
// the library itself allocates for every frame.
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

// A Draco mesh with float positions (attribute 0) and int32 vertex numbers 0..V-1 (attribute 1).
std::unique_ptr<draco::Mesh> MakeDracoMesh(int num_vertices, const Eigen::Matrix3Xi& triangles);
// A Draco point cloud with float positions (attribute 0).
std::unique_ptr<draco::PointCloud> MakeDracoPointCloud(int num_points);

// Overwrites the positions (attribute 0): point k becomes column order[k], or k without an order.
void SetDracoPositions(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                       const std::vector<int32_t>& order, draco::PointCloud* cloud);

// A Draco point cloud with three int32 attributes of one component (0, 1, 2: x, y, z): apart they
// decode in half the time of one attribute with three components.
std::unique_ptr<draco::PointCloud> MakeDracoResidualCloud(int num_points);
void SetDracoResiduals(const Eigen::Matrix3Xi& residuals, draco::PointCloud* cloud);
absl::Status EncodeDracoResiduals(const draco::PointCloud& cloud, int speed, std::string* bytes);

absl::Status EncodeDracoMesh(const draco::Mesh& mesh, const QuantizationBox& box, MeshMethod method,
                             int speed, std::string* bytes);
absl::Status EncodeDracoPointCloud(const draco::PointCloud& cloud, const QuantizationBox& box,
                                   int speed, std::string* bytes);

}  // namespace pleat
