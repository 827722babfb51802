#include "glb_primitives.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace pleat {

using nlohmann::json;

Eigen::Matrix3Xf GlbPrimitives::Spread(const Eigen::Matrix3Xf& values) const {
  Eigen::Matrix3Xf spread(3, static_cast<Eigen::Index>(split_.sources.size()));
  spread.leftCols(values.cols()) = values;
  for (Eigen::Index v = values.cols(); v < spread.cols(); ++v) {
    spread.col(v) = values.col(split_.sources[static_cast<size_t>(v)]);
  }
  return spread;
}

void GlbPrimitives::AddTexcoords(GlbBuffers* buffers, json* attributes) const {
  if (split_.texcoords.empty()) return;
  std::vector<float> texcoords;
  for (const Eigen::Vector2f& texcoord : split_.texcoords) {
    texcoords.insert(texcoords.end(), {texcoord.x(), 1 - texcoord.y()});
  }
  (*attributes)["TEXCOORD_0"] = buffers->Add(texcoords, "VEC2", 2, kVertexBuffer);
}

void GlbPrimitives::AddVertexIds(GlbBuffers* buffers, json* attributes) const {
  // The specification wants attributes of floats, whole numbers of up to 16 bits, or both.
  const std::vector<float> ids(split_.sources.begin(), split_.sources.end());
  (*attributes)["_VERTEX_ID"] = buffers->Add(ids, "SCALAR", 1, kVertexBuffer);
}

json GlbPrimitives::Primitives(const json& attributes, const json& targets,
                               GlbBuffers* buffers) const {
  std::vector<int32_t> order;
  std::vector<std::vector<uint32_t>> indices;
  for (Eigen::Index t = 0; t < split_.triangles.cols(); ++t) {
    const int32_t material =
        split_.triangle_materials.empty() ? -1 : split_.triangle_materials[static_cast<size_t>(t)];
    size_t p = 0;
    while (p < order.size() && order[p] != material) ++p;
    if (p == order.size()) {
      order.push_back(material);
      indices.emplace_back();
    }
    for (int c = 0; c < 3; ++c) {
      indices[p].push_back(static_cast<uint32_t>(split_.triangles(c, t)));
    }
  }
  json primitives = json::array();
  for (size_t p = 0; p < order.size(); ++p) {
    json primitive = {{"attributes", attributes},
                      {"indices", buffers->Add(indices[p], "SCALAR", 1, kIndexBuffer)}};
    if (order[p] >= 0) primitive["material"] = order[p];
    if (!targets.is_null()) primitive["targets"] = targets;
    primitives.push_back(std::move(primitive));
  }
  return primitives;
}

void AddGlbMaterials(const MeshAppearance& appearance, json* root) {
  for (const std::string& name : appearance.material_names) {
    (*root)["materials"].push_back({{"name", name}});
  }
}

}  // namespace pleat
