// The decoding half of the Draco library for frames of a stream. Memory is bounded on any bytes,
// because the caller knows all counts beforehand.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

// Decodes a mesh of exactly `num_points` points and `num_triangles` triangles with float positions
// and int32 vertex numbers in [0, num_vertices). positions: 3 x num_points; point_vertices:
// num_points; triangles: 3 x num_triangles, indices of points that exist. kDataLoss says what is
// wrong with the bytes, kResourceExhausted that memory ran out; the same holds for the others.
absl::Status DecodeDracoMesh(std::string_view bytes, int num_points, int num_triangles,
                             int num_vertices, Eigen::Matrix3Xf* positions,
                             std::vector<int32_t>* point_vertices, Eigen::Matrix3Xi* triangles);

// Decodes a point cloud of exactly `num_points` points in sequential order. positions: 3 x
// num_points.
absl::Status DecodeDracoPointCloud(std::string_view bytes, int num_points,
                                   Eigen::Matrix3Xf* positions);

// Does the same for three int32 attributes of one component each. residuals: 3 x num_points.
absl::Status DecodeDracoResiduals(std::string_view bytes, int num_points,
                                  Eigen::Matrix3Xi* residuals);

}  // namespace pleat
