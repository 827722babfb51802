// The parts of the mesh that a glTF file shows, before they are placed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "glb_skin.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// Vertices that one node places: all those of a POSITION accessor.
struct GlbPart {
  int node = -1;
  int first_vertex = 0;                                   // in the mesh
  int skin = -1;                                          // index in GlbMesh::skins, -1 = none
  Eigen::Matrix3Xd positions{};                           // as the accessor has them
  std::vector<std::vector<JointInfluence>> influences{};  // of the skin; empty without one
};

struct GlbMesh {
  std::vector<GlbPart> parts;
  std::vector<GlbSkin> skins;  // of the file, in its order; those that no part uses are empty
  Topology topology;
  MeshAppearance appearance;
  std::vector<InputNote> notes;
};

// Reads what the shown nodes hold. Errors as in DecodeGlb, without the name of the file.
absl::StatusOr<GlbMesh> ReadGlbMesh(const GlbContainer& glb, const GlbNodes& nodes,
                                    const MeshLimits& limits);

// Places all parts where the nodes are: 3 x V in the order of the topology. The transform of a node
// whose mesh is skinned does not count (glTF 2.0, section 3.7.3.3): its joints pose it.
Eigen::Matrix3Xf PlaceGlbMesh(const GlbMesh& mesh, const GlbNodes& nodes);

}  // namespace pleat
