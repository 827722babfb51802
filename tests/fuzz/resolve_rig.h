// What follows a rig's parser: the rig of a clip. The clip is the mesh of the seeds.
#pragma once

#include <Eigen/Core>

#include "pleat/formats/rig_file.h"

namespace pleat {

// Traps when a rig comes out that is not valid.
inline void ResolveForSmallClip(const RigFile& file) {
  static const MeshSequence& clip = *[] {
    Eigen::Matrix3Xf frame(3, 4);
    frame << 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1;
    Topology topology = Topology::Create(4, {0, 1, 2, 0, 2, 3}, {3, 3}).value();
    return new MeshSequence(MeshSequence::Create(std::move(topology), {frame}).value());
  }();
  for (const auto& vertex : file.influences) {
    for (const JointInfluence& influence : vertex) {
      if (influence.joint < 0 || influence.joint >= file.skeleton.num_joints()) __builtin_trap();
    }
  }
  const auto rig = ResolveRig(file, clip);
  if (!rig.ok() || !rig->weights) return;
  for (const VertexInfluences& vertex : rig->weights->influences()) {
    float total = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
      if (!(vertex.weights[k] >= 0)) __builtin_trap();
      if (vertex.weights[k] > 0 && vertex.bones[k] >= rig->skeleton.num_joints()) __builtin_trap();
      total += vertex.weights[k];
    }
    if (!(total > .999f && total < 1.001f)) __builtin_trap();
  }
}

}  // namespace pleat
