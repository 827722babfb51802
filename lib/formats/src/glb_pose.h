// A glTF mesh in a pose of its nodes, joints and morph targets.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "glb_mesh.h"
#include "glb_nodes.h"

namespace pleat {

// Places all parts where the nodes are: 3 x V in the order of the topology. The transform of a node
// whose mesh is skinned does not count (glTF 2.0, section 3.7.3.3): its joints pose it.
// weights: of the morph targets of each part; parts and targets without one do not morph.
Eigen::Matrix3Xf PlaceGlbMesh(const GlbMesh& mesh, const GlbNodes& nodes,
                              const std::vector<std::vector<float>>& weights);

}  // namespace pleat
