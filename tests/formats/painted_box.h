// A box that moves, with everything that a mesh may have: for writers, which must keep it.
#pragma once

#include <string>
#include <vector>

#include "pleat/formats/obj_writer.h"
#include "pleat/mesh/mesh_sequence.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {

// Quads, and with `has_triangle` two triangles in place of the first. Its texture coordinates meet
// at seams; the second material has a letter beyond ASCII.
inline MeshSequence PaintedBox(int num_frames, bool has_triangle = false) {
  const MeshShape box = MakeBox({1, 2, 3});
  std::vector<int32_t> corners = box.topology.corner_vertices();
  std::vector<int32_t> sizes(6, 4);
  if (has_triangle) {
    corners.insert(corners.begin() + 3, {corners[0], corners[2]});
    sizes = {3, 3, 4, 4, 4, 4, 4};
  }
  MeshSequenceOptions options{.name = "box \xc3\xa4", .frame_rate = {30000, 1001}};
  options.appearance.texcoords = {{0, 0}, {1, 0}, {1, 0.25f}, {0, 0.1f}};
  for (size_t c = 0; c < corners.size(); ++c) {
    options.appearance.corner_texcoords.push_back(static_cast<int32_t>((c + c / 5) % 4));
  }
  options.appearance.material_names = {"skin", "Stoff \xc3\xa4"};
  for (size_t f = 0; f < sizes.size(); ++f) {
    options.appearance.face_materials.push_back(f < 2 ? 0 : 1);
  }
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf frame = box.positions.cast<float>();
    frame.row(1).array() += 0.37f * static_cast<float>(t);
    frame *= 1 + 0.0123f * static_cast<float>(t);
    frames.push_back(frame);
  }
  return MeshSequence::Create(Topology::Create(8, corners, sizes).value(), std::move(frames),
                              std::move(options))
      .value();
}

inline void WriteMeshOf(const MeshSequence& sequence, const std::string& path) {
  EXPECT_THAT(WriteObj(path, sequence.topology(), sequence.frame(0), sequence.appearance()),
              IsOk());
}

}  // namespace pleat
