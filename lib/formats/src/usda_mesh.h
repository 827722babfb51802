// The parts of a mesh in USD text that do not move: faces, texture coordinates, materials.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

// A mesh directly below the prim `root`, which has the materials too. Topology and appearance must
// outlive it.
class UsdaMesh {
 public:
  UsdaMesh(const Topology& topology, const MeshAppearance& appearance, std::string root);

  bool has_materials() const { return !materials_.empty(); }
  // Attributes of the mesh.
  void AppendFaces(std::string* text) const;
  void AppendTexcoords(std::string* text) const;
  // Prims below the mesh, one for each material with its faces.
  void AppendSubsets(std::string* text) const;
  // Prims below the root.
  void AppendMaterials(std::string* text) const;

 private:
  const Topology& topology_;
  const MeshAppearance& appearance_;
  const std::string root_;
  std::vector<std::string> materials_;       // the names of their prims
  std::vector<std::vector<int32_t>> faces_;  // of each material
};

}  // namespace pleat
