#include "pleat/mesh/topology.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

// Checks that every index of `indices` is -1 (none) or names one of `num_items` items.
absl::Status CheckIndices(const std::vector<int32_t>& indices, int num_expected, size_t num_items,
                          absl::string_view what) {
  if (indices.empty()) return absl::OkStatus();
  if (indices.size() != static_cast<size_t>(num_expected)) {
    return absl::InvalidArgumentError(
        absl::StrCat("there are ", indices.size(), " ", what, " for ", num_expected));
  }
  for (size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < -1 || indices[i] >= static_cast<int64_t>(num_items)) {
      return absl::InvalidArgumentError(
          absl::StrCat(what, ": entry ", i, " is ", indices[i], ", there are ", num_items));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Topology> Topology::Create(int num_vertices, std::vector<int32_t> corner_vertices,
                                          std::vector<int32_t> face_sizes) {
  if (num_vertices <= 0) {
    return absl::InvalidArgumentError("a mesh needs at least one vertex");
  }
  Topology topology;
  topology.num_vertices_ = num_vertices;
  topology.face_starts_.reserve(face_sizes.size() + 1);
  topology.face_starts_.push_back(0);
  // 64 bits, and the loop ends at the first excess: sizes may come from a hostile file.
  int64_t num_triangles = 0, num_corners = 0;
  for (size_t f = 0; f < face_sizes.size(); ++f) {
    if (face_sizes[f] < 3) {
      return absl::InvalidArgumentError(
          absl::StrCat("face ", f, " has ", face_sizes[f], " corners; a face needs at least 3"));
    }
    num_corners += face_sizes[f];
    num_triangles += face_sizes[f] - 2;
    if (num_corners > static_cast<int64_t>(corner_vertices.size())) break;
    topology.face_starts_.push_back(static_cast<int32_t>(num_corners));
  }
  if (num_corners != static_cast<int64_t>(corner_vertices.size())) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the faces declare ", num_corners, " corners but ", corner_vertices.size(), " are given"));
  }
  topology.corner_vertices_ = std::move(corner_vertices);
  topology.triangles_.resize(3, num_triangles);
  Eigen::Index triangle = 0;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const std::span<const int32_t> corners = topology.face(f);
    for (size_t c = 0; c < corners.size(); ++c) {
      if (corners[c] < 0 || corners[c] >= num_vertices) {
        return absl::InvalidArgumentError(absl::StrCat("face ", f, " names vertex ", corners[c],
                                                       ", the mesh has vertices 0 to ",
                                                       num_vertices - 1));
      }
      if (c >= 2) {
        topology.triangles_.col(triangle++) << corners[0], corners[c - 1], corners[c];
      }
    }
  }
  return topology;
}

absl::StatusOr<Topology> Topology::FromTriangles(int num_vertices,
                                                 const Eigen::Matrix3Xi& triangles) {
  return Create(num_vertices,
                std::vector<int32_t>(triangles.data(), triangles.data() + triangles.size()),
                std::vector<int32_t>(triangles.cols(), 3));
}

absl::Status CheckAppearance(const MeshAppearance& appearance, const Topology& topology) {
  if (absl::Status status = CheckIndices(appearance.corner_texcoords, topology.num_corners(),
                                         appearance.texcoords.size(), "corner texture coordinates");
      !status.ok()) {
    return status;
  }
  return CheckIndices(appearance.face_materials, topology.num_faces(),
                      appearance.material_names.size(), "face materials");
}

}  // namespace pleat
