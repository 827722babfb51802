// What a stream of frames says once, before its first frame.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

enum class FrameEncoding {
  kDracoMesh,        // every frame is a Draco mesh that can be read alone
  kDracoPointCloud,  // every frame is a Draco point cloud in the vertex order of the header
  // Key frames as above; between them Draco point clouds of three int32 attributes, what a
  // prediction from the last frame leaves (docs/formats/frame_stream.md). Lossless on the grid.
  kDracoDelta,
};

// What of the character frames hold.
enum class StreamContent {
  kMesh,         // every vertex
  kControlMesh,  // a twentieth of the vertices with triangles of their own, encoded alike
  // Pose and detail coefficients (FrameParameters), for readers that have the model: no Draco.
  kParameters,
};

// What a reader needs beside the bytes of a frame of a kDracoDelta stream.
struct FrameMark {
  bool keyframe = true;   // else a difference to the frame before
  uint32_t checksum = 0;  // of the frame's integers on the grid; 0 in other streams

  friend bool operator==(const FrameMark&, const FrameMark&) = default;
};

// One grid for a whole session: a coordinate x of axis a becomes the integer
// round((x - origin_m[a]) / step_m()). Draco calls this explicit quantization; it does not clip, so
// positions outside the box only cost more bits.
struct QuantizationBox {
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();  // lowest corner
  float range_m = 1;                                   // edge length of the cube, > 0
  int bits = 12;                                       // per coordinate, kMinBits..kMaxBits

  static constexpr int kMinBits = 8, kMaxBits = 20;
  // Largest distance from the box that is still encoded, in box edges.
  static constexpr float kMaxEdgesOutside = 16;

  // Distance of two neighboring grid points; an encoded coordinate is wrong by at most half of it.
  double step_m() const { return static_cast<double>(range_m) / ((1 << bits) - 1); }
  // kInvalidArgument names what is wrong.
  absl::Status Validate() const;

  friend bool operator==(const QuantizationBox&, const QuantizationBox&) = default;
};

struct StreamHeader {
  FrameEncoding encoding = FrameEncoding::kDracoPointCloud;
  StreamContent content = StreamContent::kMesh;
  int num_vertices = 0;   // V, of the character or of its control mesh
  int num_points = 0;     // of the topology mesh: V, or more where Draco splits a vertex
  int num_triangles = 0;  // of the topology mesh
  QuantizationBox box;
  // Draco mesh of the reference frame; its int32 generic attribute says for every point which
  // vertex of the character it is.
  std::string topology;
  // Point k of a point cloud is vertex vertex_order[k]: a permutation of 0..V-1. It is the order in
  // which the topology mesh first shows the vertices (neighbors follow each other, which codes
  // samba in 24.5 kB in place of 34.6), then the vertices it does not show.
  std::vector<int32_t> vertex_order;
  // Of kControlMesh, V: vertex i of the control mesh is vertex control_vertices[i] of the
  // character, ascending. kParameters has none of this but num_vertices.
  std::vector<int32_t> control_vertices{};
};

}  // namespace pleat
