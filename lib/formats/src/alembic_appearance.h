// Texture coordinates and materials of an Alembic mesh.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "alembic_archive.h"
#include "alembic_mesh.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Reads `uv` and the face sets below the mesh, sample 0 of both. What does not fit the mesh is left
// out; `notes` receives that and what else of the mesh is not kept, without its path. An error
// means that the file is damaged.
absl::StatusOr<MeshAppearance> ReadAlembicAppearance(const AlembicMesh& mesh,
                                                     const AlembicFaces& faces, int num_vertices,
                                                     AlembicArchive* archive,
                                                     std::vector<InputNote>* notes);

}  // namespace pleat
