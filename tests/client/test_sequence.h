// A small sequence whose frames differ, and what tests do with it.
#pragma once

#include <utility>
#include <vector>

#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// A tetrahedron that grows and moves along x.
inline MeshSequence MovingTetrahedron(int num_frames) {
  Eigen::Matrix3Xi triangles(3, 4);
  triangles << 0, 0, 0, 1,  //
      2, 1, 3, 2,           //
      1, 3, 2, 3;
  Eigen::Matrix3Xf corners(3, 4);
  corners << 0, 1, 0, 0,  //
      0, 0, 1, 0,         //
      0, 0, 0, 1;
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf frame = corners * (1 + 0.01f * t);
    frame.row(0).array() += 0.1f * t;
    frames.push_back(frame);
  }
  return MeshSequence::Create(
             *Topology::FromTriangles(4, triangles), std::move(frames),
             {.name = "tetrahedron", .frame_rate = {24, 1}, .appearance = {}, .frame_names = {}})
      .value();
}

// The same animation with every vertex of every frame moved.
inline MeshSequence Moved(const MeshSequence& sequence, const Eigen::Vector3f& by) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    frames.emplace_back(sequence.frame(t).colwise() + by);
  }
  return MeshSequence::Create(sequence.topology(), std::move(frames)).value();
}

}  // namespace pleat
