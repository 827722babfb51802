// The connectivity that all frames of a sequence share: polygons, texture corners, materials.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// Polygons of one mesh as the file listed them, valid by construction: every face has at least
// three corners and every corner names a vertex in [0, num_vertices).
class Topology {
 public:
  // Checks and takes the faces. corner_vertices: the faces' corners one after the other;
  // face_sizes: corners per face. The error is kInvalidArgument and names the first bad face
  // (0-based).
  static absl::StatusOr<Topology> Create(int num_vertices, std::vector<int32_t> corner_vertices,
                                         std::vector<int32_t> face_sizes);
  // Makes a topology of triangles, 3 x F, with the same checks.
  static absl::StatusOr<Topology> FromTriangles(int num_vertices,
                                                const Eigen::Matrix3Xi& triangles);

  int num_vertices() const { return num_vertices_; }
  int num_faces() const { return static_cast<int>(face_starts_.size()) - 1; }
  int num_corners() const { return static_cast<int>(corner_vertices_.size()); }
  int num_triangles() const { return static_cast<int>(triangles_.cols()); }

  // The vertices of face f in file order.
  std::span<const int32_t> face(int f) const {
    return std::span(corner_vertices_)
        .subspan(face_starts_[f], face_starts_[f + 1] - face_starts_[f]);
  }
  int face_start(int f) const { return face_starts_[f]; }  // first corner of face f
  const std::vector<int32_t>& corner_vertices() const { return corner_vertices_; }

  // The fan triangulation, 3 x num_triangles, oriented as in the file. Triangles of a face follow
  // each other, in the order of faces.
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }

  friend bool operator==(const Topology& a, const Topology& b) {
    return a.num_vertices_ == b.num_vertices_ && a.corner_vertices_ == b.corner_vertices_ &&
           a.face_starts_ == b.face_starts_;
  }

 private:
  int num_vertices_ = 0;
  std::vector<int32_t> corner_vertices_;
  std::vector<int32_t> face_starts_;  // num_faces + 1
  Eigen::Matrix3Xi triangles_;
};

// What a file says beyond geometry, kept untouched from input to export. Lists are empty where it
// says nothing.
struct MeshAppearance {
  std::vector<Eigen::Vector2f> texcoords;
  std::vector<int32_t> corner_texcoords;  // per corner: index into texcoords, -1 = none
  std::vector<std::string> material_names;
  std::vector<int32_t> face_materials;  // per face: index into material_names, -1 = none
  std::string material_library;         // OBJ mtllib
};

// Returns kInvalidArgument when an index of `appearance` is out of range or a list has the wrong
// length.
absl::Status CheckAppearance(const MeshAppearance& appearance, const Topology& topology);

}  // namespace pleat
