// Vertices that an exporter repeated, joined again by the attribute _VERTEX_ID.
#pragma once

#include <optional>
#include <vector>

#include "glb_mesh.h"

namespace pleat {

// Of each original vertex, the first vertex that has its number. None when the mesh has no numbers,
// several parts, or numbers that do not count from 0 without a gap.
std::optional<std::vector<int32_t>> OriginalVertices(const GlbMesh& mesh);

// Joins the vertices of mesh and frames when repetitions are at the same place in every frame; says
// whether they were.
bool JoinVertices(const std::vector<int32_t>& originals, GlbMesh* mesh,
                  std::vector<Eigen::Matrix3Xf>* frames);

}  // namespace pleat
