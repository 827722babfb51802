#include "glb_vertex_ids.h"

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

int32_t IdOf(const GlbAccessor& ids, int v) {
  const double id = ids.At(static_cast<size_t>(v), 0);
  const bool is_number = id >= 0 && id < static_cast<double>(ids.count()) && id == std::floor(id);
  return is_number ? static_cast<int32_t>(id) : -1;
}

}  // namespace

std::optional<std::vector<int32_t>> OriginalVertices(const GlbMesh& mesh) {
  if (mesh.parts.size() != 1 || !mesh.parts[0].vertex_ids) return std::nullopt;
  const GlbAccessor& ids = *mesh.parts[0].vertex_ids;
  const int num_vertices = mesh.topology.num_vertices();
  if (ids.count() != static_cast<size_t>(num_vertices)) return std::nullopt;
  std::vector<int32_t> originals;
  for (int v = 0; v < num_vertices; ++v) {
    const int32_t id = IdOf(ids, v);
    if (id < 0) return std::nullopt;
    if (static_cast<size_t>(id) >= originals.size())
      originals.resize(static_cast<size_t>(id) + 1, -1);
    if (originals[id] < 0) originals[id] = v;
  }
  if (std::ranges::count(originals, -1) > 0) return std::nullopt;
  return originals;
}

bool JoinVertices(const std::vector<int32_t>& originals, GlbMesh* mesh,
                  std::vector<Eigen::Matrix3Xf>* frames) {
  const GlbAccessor& ids = *mesh->parts[0].vertex_ids;
  std::vector<int32_t> id_of;
  for (int v = 0; v < mesh->topology.num_vertices(); ++v) id_of.push_back(IdOf(ids, v));
  for (const Eigen::Matrix3Xf& frame : *frames) {
    for (size_t v = 0; v < id_of.size(); ++v) {
      if (frame.col(static_cast<Eigen::Index>(v)) != frame.col(originals[id_of[v]])) return false;
    }
  }
  for (Eigen::Matrix3Xf& frame : *frames) {
    Eigen::Matrix3Xf joined(3, static_cast<Eigen::Index>(originals.size()));
    for (size_t id = 0; id < originals.size(); ++id) {
      joined.col(static_cast<Eigen::Index>(id)) = frame.col(originals[id]);
    }
    frame = std::move(joined);
  }
  std::vector<int32_t> corners = mesh->topology.corner_vertices();
  for (int32_t& corner : corners) corner = id_of[corner];
  mesh->topology = Topology::Create(static_cast<int>(originals.size()), std::move(corners),
                                    std::vector<int32_t>(mesh->topology.num_faces(), 3))
                       .value();
  return true;
}

}  // namespace pleat
