// A mesh as the primitives of a glTF file that is written.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "glb_buffers.h"
#include "pleat/mesh/topology.h"
#include "split_vertices.h"

namespace pleat {

class GlbPrimitives {
 public:
  GlbPrimitives(const Topology& topology, const MeshAppearance& appearance)
      : split_(SplitAtSeams(topology, appearance)) {}

  size_t num_vertices() const { return split_.sources.size(); }  // repetitions included
  size_t num_triangles() const { return static_cast<size_t>(split_.triangles.cols()); }
  const std::vector<int32_t>& sources() const { return split_.sources; }
  // Values of the vertices of the topology (3 x V) for all vertices of the file.
  Eigen::Matrix3Xf Spread(const Eigen::Matrix3Xf& values) const;

  // Adds TEXCOORD_0 where the mesh has texture coordinates.
  void AddTexcoords(GlbBuffers* buffers, nlohmann::json* attributes) const;
  // Adds _VERTEX_ID: the vertex of the topology for every vertex of the file.
  void AddVertexIds(GlbBuffers* buffers, nlohmann::json* attributes) const;
  // A primitive for each material, in the order in which faces have them. All have `attributes`,
  // and `targets` unless it is null.
  nlohmann::json Primitives(const nlohmann::json& attributes, const nlohmann::json& targets,
                            GlbBuffers* buffers) const;

 private:
  SplitVertices split_;
};

// The materials of a file, as the primitives number them.
void AddGlbMaterials(const MeshAppearance& appearance, nlohmann::json* root);

}  // namespace pleat
