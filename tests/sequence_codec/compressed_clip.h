// A small clip and damaged forms of its compressed file.
#pragma once

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "pleat/base/sha256.h"
#include "pleat/mesh/mesh_sequence.h"
#include "support/test_meshes.h"

namespace pleat {

// A torus that turns, travels and waves, with a little noise that no model explains.
inline MeshSequence MakeWavingTorus(int m, int n, int num_frames, double noise_m = 1e-3) {
  const TestMesh mesh = MakeTorus(m, n, 5);
  Random random(11);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    const float angle = 0.05f * static_cast<float>(t);
    Eigen::Matrix3Xf frame = mesh.positions;
    for (int v = 0; v < frame.cols(); ++v) {
      frame(1, v) += 0.2f * std::sin(3 * mesh.positions(0, v) + 4 * angle);
      for (int c = 0; c < 3; ++c) frame(c, v) += static_cast<float>(noise_m * random.Normal());
    }
    Eigen::Matrix3f turn;
    turn << std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle);
    frame = (turn * frame).colwise() + Eigen::Vector3f(angle, 1, 0);
    frames.push_back(std::move(frame));
  }
  MeshSequenceOptions options;
  options.name = "waving torus";
  options.frame_rate = {24000, 1001};
  return MeshSequence::Create(mesh.topology, std::move(frames), std::move(options)).value();
}

// The same bytes with the right checksum in front of every section, as far as they form sections:
// damage then reaches what lies behind the checksums.
inline std::string ResealSections(std::string bytes) {
  size_t at = 12;
  while (at + 9 <= bytes.size()) {
    uint32_t size;
    std::memcpy(&size, bytes.data() + at + 1, 4);
    if (size > bytes.size() - at - 9) break;
    const Sha256Digest digest = ComputeSha256(std::string_view(bytes).substr(at + 9, size));
    std::memcpy(bytes.data() + at + 5, digest.data(), 4);
    at += 9 + size;
  }
  return bytes;
}

}  // namespace pleat
