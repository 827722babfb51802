// A skinned figure as a binary glTF file.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/skinned_figure.h"

namespace pleat {

inline SkinnedFigure SmallFigure() { return MakeSkinnedFigure({.num_rings = 2, .num_sides = 3}); }

inline MeshSequence StillClip(const SkinnedFigure& figure) {
  return *MeshSequence::Create(figure.topology, {figure.rig.rest_positions.cast<float>()},
                               {.name = "figure"});
}

struct FigureGltf {
  nlohmann::json root;
  std::string binary;

  // Adds values of a glTF component type and returns the number of their buffer view and accessor.
  template <typename T>
  size_t Add(const std::vector<T>& values, int component, const char* type, int count) {
    root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"type", type},
                                 {"count", count}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    binary.resize((binary.size() + 3) / 4 * 4);
    return root["accessors"].size() - 1;
  }
};

// A binary glTF of a figure: the skin's joints in reverse order, an armature node that scales from
// centimeters, weights of joints (that of a bone belongs to the joint it turns about).
inline FigureGltf MakeFigureGltf(const SkinnedFigure& figure) {
  const Skeleton& skeleton = figure.rig.skeleton;
  const int num_joints = skeleton.num_joints();
  const int num_vertices = figure.topology.num_vertices();
  FigureGltf gltf;
  nlohmann::json& root = gltf.root;
  std::vector<float> positions, weights, binds;
  std::vector<uint16_t> joints;
  for (int v = 0; v < num_vertices; ++v) {
    for (int k = 0; k < 3; ++k) {
      positions.push_back(static_cast<float>(100 * figure.rig.rest_positions(k, v)));
    }
    const VertexInfluences& influences = figure.rig.weights.vertex(v);
    for (int k = 0; k < 4; ++k) {
      const int parent = influences.weights[k] > 0 ? skeleton.parent(influences.bones[k]) : 0;
      joints.push_back(static_cast<uint16_t>(num_joints - 1 - parent));
      weights.push_back(influences.weights[k]);
    }
  }
  root["scene"] = 0;
  root["nodes"] = {{{"name", "armature"}, {"scale", {.01, .01, .01}}, {"children", {1}}}};
  for (int j = 0; j < num_joints; ++j) {
    const Eigen::Vector3d parent = skeleton.parent(j) < 0
                                       ? Eigen::Vector3d(0, 0, 0)
                                       : skeleton.rest_position(skeleton.parent(j));
    const Eigen::Vector3d offset = 100 * (skeleton.rest_position(j) - parent);
    nlohmann::json node = {{"name", skeleton.joint(j).name},
                           {"translation", {offset.x(), offset.y(), offset.z()}}};
    for (const int child : skeleton.children(j)) node["children"].push_back(child + 1);
    root["nodes"].push_back(node);
  }
  root["nodes"].push_back({{"name", "body"}, {"mesh", 0}, {"skin", 0}});
  for (int j = num_joints - 1; j >= 0; --j) {
    root["skins"][0]["joints"].push_back(j + 1);
    for (int k = 0; k < 16; ++k) {
      binds.push_back(k % 5 == 0 ? 1.f
                      : k >= 12  ? static_cast<float>(-100 * skeleton.rest_position(j)[k - 12])
                                 : 0.f);
    }
  }
  gltf.Add(positions, 5126, "VEC3", num_vertices);
  gltf.Add(joints, 5123, "VEC4", num_vertices);
  gltf.Add(weights, 5126, "VEC4", num_vertices);
  gltf.Add(binds, 5126, "MAT4", num_joints);
  root["skins"][0]["inverseBindMatrices"] = 3;
  root["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}}}}}};
  root["asset"]["version"] = "2.0";
  return gltf;
}

inline std::string PackFigureGltf(FigureGltf gltf) {
  gltf.root["buffers"].push_back({{"byteLength", gltf.binary.size()}});
  std::string text = gltf.root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto u32 = [](size_t value) {
    const auto narrow = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&narrow), 4);
  };
  return "glTF" + u32(2) + u32(28 + text.size() + gltf.binary.size()) + u32(text.size()) + "JSON" +
         text + u32(gltf.binary.size()) + std::string("BIN\0", 4) + gltf.binary;
}

}  // namespace pleat
