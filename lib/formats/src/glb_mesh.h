// The parts of the mesh that a glTF file shows, before they are placed.
#pragma once

#include <Eigen/Core>
#include <optional>
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
  // The differences of its morph targets, as many elements as positions; none where a target does
  // not move.
  std::vector<std::optional<GlbAccessor>> targets{};
  std::optional<GlbAccessor> vertex_ids{};  // attribute _VERTEX_ID
};

struct GlbMesh {
  std::vector<GlbPart> parts;
  std::vector<GlbSkin> skins;  // of the file, in its order; those that no part uses are empty
  Topology topology;
  MeshAppearance appearance;
  std::vector<InputNote> notes;
};

// Reads what the shown nodes hold. is_still: without morph targets, and a note says what moves and
// is not read. Errors as in DecodeGlb, without the name of the file. The container must outlive the
// mesh.
absl::StatusOr<GlbMesh> ReadGlbMesh(const GlbContainer& glb, const GlbNodes& nodes, bool is_still,
                                    const MeshLimits& limits);

}  // namespace pleat
