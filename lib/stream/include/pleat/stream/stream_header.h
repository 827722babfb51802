// What a stream of frames says once, before its first frame (docs/formats/frame_stream.md).
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
  // Key frames are point clouds as above. The frames between them are Draco point clouds with three
  // int32 attributes, which hold what a prediction from the last frame leaves. They restore the
  // integers on the grid exactly, so errors do not add up.
  kDracoDelta,
};

// Which part of the character a frame holds.
enum class StreamContent {
  kMesh,         // every vertex
  kControlMesh,  // a twentieth of the vertices with triangles of their own, encoded the same way
  // The pose and the detail coefficients (FrameParameters), without Draco, for readers that have
  // the model.
  kParameters,
};

// What a reader needs beside the bytes of a frame in a kDracoDelta stream.
struct FrameMark {
  bool keyframe = true;   // false: the frame is a difference from the one before it
  uint32_t checksum = 0;  // FNV-1a over the frame's integers on the grid; 0 in other streams

  friend bool operator==(const FrameMark&, const FrameMark&) = default;
};

// One grid serves the whole session: the coordinate x on axis a becomes the integer
// round((x - origin_m[a]) / step_m()). Draco calls this explicit quantization. It does not clip, so
// positions outside the box only cost more bits.
struct QuantizationBox {
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();  // lowest corner
  float range_m = 1;                                   // edge length of the cube, > 0
  int bits = 12;                                       // per coordinate, kMinBits..kMaxBits

  static constexpr int kMinBits = 8, kMaxBits = 20;
  // The largest distance from the box that is still encoded, in box edges.
  static constexpr float kMaxEdgesOutside = 16;

  // The distance between neighboring grid points. An encoded coordinate is off by at most half of
  // it.
  double step_m() const { return static_cast<double>(range_m) / ((1 << bits) - 1); }
  // kInvalidArgument says which of the three values is out of range.
  absl::Status Validate() const;

  friend bool operator==(const QuantizationBox&, const QuantizationBox&) = default;
};

struct StreamHeader {
  FrameEncoding encoding = FrameEncoding::kDracoPointCloud;
  StreamContent content = StreamContent::kMesh;
  int num_vertices = 0;   // V: the vertices of the character, or of its control mesh
  int num_points = 0;     // points of the topology mesh: V, or more where Draco splits a vertex
  int num_triangles = 0;  // triangles of the topology mesh
  QuantizationBox box;
  // The reference frame as a Draco mesh. Its int32 generic attribute says for every point which
  // vertex of the character it is.
  std::string topology;
  // Point k of a point cloud is the vertex vertex_order[k]. This permutation of 0..V-1 is the order
  // in which the topology mesh first shows the vertices, followed by any that it does not show.
  // Neighbors on the surface then follow each other, which makes samba's clouds 24.5 kB in place of
  // 34.6.
  std::vector<int32_t> vertex_order;
  // V entries for kControlMesh, none otherwise: vertex i of the control mesh is the vertex
  // control_vertices[i] of the character. The entries ascend.
  // A stream of kParameters sets only `content` and num_vertices.
  std::vector<int32_t> control_vertices{};
};

}  // namespace pleat
