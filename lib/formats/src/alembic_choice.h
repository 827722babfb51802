// Which meshes of an Alembic archive make the sequence, and when its frames are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "alembic_archive.h"
#include "alembic_mesh.h"
#include "alembic_xform.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

// A transform and the next one above it.
struct PlacedXform {
  AlembicXform xform;
  int parent = -1;        // index into AlembicChoice::xforms, -1 = none
  bool moves = false;     // it or one that it is relative to changes
  int most_samples = -1;  // of these, the one that changes with the most samples
};

struct PlacedMesh {
  AlembicMesh mesh;
  int num_vertices = 0;
  int xform = -1;  // index into AlembicChoice::xforms, -1 = none above it
  bool moves = false;
  AlembicTimes times;

  // Whether the samples of the mesh itself change.
  bool deforms() const {
    return mesh.positions.changes() || mesh.face_indices.changes() || mesh.face_counts.changes();
  }
};

struct AlembicChoice {
  std::vector<PlacedMesh> meshes;   // in the order of the file, at least one
  std::vector<PlacedXform> xforms;  // all above meshes of the archive, parents first
  AlembicTimes times;               // of the frames
};

// object: the path of a mesh, or of an object with meshes below it; empty for all that move.
// `notes` receives what is left out. kNotFound when there is no such object or no mesh,
// kInvalidArgument when the meshes have samples at different times.
absl::StatusOr<AlembicChoice> ChooseAlembicMeshes(const std::string& object,
                                                  const MeshLimits& limits, AlembicArchive* archive,
                                                  std::vector<InputNote>* notes);

}  // namespace pleat
