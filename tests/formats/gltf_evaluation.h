// A glTF file shown at a key of its animation, as the specification says it (sections 3.7 and 3.11)
// and without anything of lib/formats: what an engine would draw.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pleat {

class GltfEvaluation {
 public:
  explicit GltfEvaluation(const std::string& bytes) {
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    root = nlohmann::json::parse(bytes.substr(20, length));
    binary_ = bytes.substr(20 + length + 8);
  }

  nlohmann::json root;

  // The numbers of an accessor of floats, uint32 or uint16.
  std::vector<double> Numbers(size_t accessor) const {
    const nlohmann::json& entry = root["accessors"][accessor];
    const std::string type = entry["type"];
    const size_t components = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : type[3] - '0';
    const size_t offset = root["bufferViews"][entry["bufferView"].get<size_t>()]["byteOffset"];
    const int kind = entry["componentType"];
    std::vector<double> numbers(entry["count"].get<size_t>() * components);
    for (size_t i = 0; i < numbers.size(); ++i) {
      if (kind == 5126) numbers[i] = Read<float>(offset + 4 * i);
      if (kind == 5125) numbers[i] = Read<uint32_t>(offset + 4 * i);
      if (kind == 5123) numbers[i] = Read<uint16_t>(offset + 2 * i);
    }
    return numbers;
  }
  const nlohmann::json& attributes() const {
    return root["meshes"][0]["primitives"][0]["attributes"];
  }
  size_t num_keys() const {
    if (!root.contains("animations")) return 0;
    return Numbers(root["animations"][0]["samplers"][0]["input"]).size();
  }

  // All vertices of the file with the nodes at a key of the animation; at rest without one.
  Eigen::Matrix3Xd Positions(size_t key) const {
    const nlohmann::json& nodes = root["nodes"];
    std::vector<Eigen::Vector3d> places(nodes.size(), Eigen::Vector3d::Zero());
    std::vector<Eigen::Quaterniond> turns(nodes.size(), Eigen::Quaterniond::Identity());
    std::vector<double> weights;
    for (size_t n = 0; n < nodes.size(); ++n) {
      if (!nodes[n].contains("translation")) continue;
      for (int k = 0; k < 3; ++k) places[n][k] = nodes[n]["translation"][k];
    }
    Animate(key, &places, &turns, &weights);
    std::vector<Eigen::Affine3d> world(nodes.size());
    for (const nlohmann::json& top : root["scenes"][0]["nodes"]) {
      Place(top, Eigen::Affine3d::Identity(), places, turns, &world);
    }
    return Skin(Morph(weights), world);
  }

 private:
  template <typename T>
  double Read(size_t offset) const {
    T value;
    std::memcpy(&value, binary_.data() + offset, sizeof(T));
    return static_cast<double>(value);
  }

  void Animate(size_t key, std::vector<Eigen::Vector3d>* places,
               std::vector<Eigen::Quaterniond>* turns, std::vector<double>* weights) const {
    if (!root.contains("animations")) return;
    const nlohmann::json& animation = root["animations"][0];
    for (const nlohmann::json& channel : animation["channels"]) {
      const nlohmann::json& sampler = animation["samplers"][channel["sampler"].get<size_t>()];
      const std::vector<double> all = Numbers(sampler["output"]);
      const size_t per_key = all.size() / Numbers(sampler["input"]).size();
      const double* values = all.data() + key * per_key;
      const size_t node = channel["target"]["node"];
      const std::string path = channel["target"]["path"];
      if (path == "translation") (*places)[node] = {values[0], values[1], values[2]};
      if (path == "rotation") (*turns)[node] = {values[3], values[0], values[1], values[2]};
      if (path == "weights") weights->assign(values, values + per_key);
    }
  }

  void Place(size_t node, const Eigen::Affine3d& parent, const std::vector<Eigen::Vector3d>& places,
             const std::vector<Eigen::Quaterniond>& turns,
             std::vector<Eigen::Affine3d>* world) const {
    (*world)[node] = parent * Eigen::Translation3d(places[node]) * turns[node];
    for (const nlohmann::json& child : root["nodes"][node].value("children", nlohmann::json())) {
      Place(child, (*world)[node], places, turns, world);
    }
  }

  Eigen::Matrix3Xd Morph(const std::vector<double>& weights) const {
    const std::vector<double> base = Numbers(attributes()["POSITION"]);
    Eigen::Matrix3Xd positions = Eigen::Map<const Eigen::Matrix3Xd>(
        base.data(), 3, static_cast<Eigen::Index>(base.size() / 3));
    for (size_t k = 0; k < weights.size(); ++k) {
      const std::vector<double> target =
          Numbers(root["meshes"][0]["primitives"][0]["targets"][k]["POSITION"]);
      positions +=
          weights[k] * Eigen::Map<const Eigen::Matrix3Xd>(target.data(), 3, positions.cols());
    }
    return positions;
  }

  Eigen::Matrix3Xd Skin(const Eigen::Matrix3Xd& rest,
                        const std::vector<Eigen::Affine3d>& world) const {
    const nlohmann::json& skin = root["skins"][0];
    const std::vector<double> binds = Numbers(skin["inverseBindMatrices"]);
    std::vector<Eigen::Matrix4d> motions;
    for (size_t j = 0; j < skin["joints"].size(); ++j) {
      motions.push_back(world[skin["joints"][j].get<size_t>()].matrix() *
                        Eigen::Map<const Eigen::Matrix4d>(binds.data() + 16 * j));
    }
    Eigen::Matrix3Xd positions = Eigen::Matrix3Xd::Zero(3, rest.cols());
    for (int set = 0; attributes().contains("JOINTS_" + std::to_string(set)); ++set) {
      const std::vector<double> joints = Numbers(attributes()["JOINTS_" + std::to_string(set)]);
      const std::vector<double> weights = Numbers(attributes()["WEIGHTS_" + std::to_string(set)]);
      for (Eigen::Index v = 0; v < rest.cols(); ++v) {
        for (size_t k = 4 * static_cast<size_t>(v); k < 4 * static_cast<size_t>(v) + 4; ++k) {
          positions.col(v) +=
              weights[k] *
              (motions[static_cast<size_t>(joints[k])] * rest.col(v).homogeneous()).head<3>();
        }
      }
    }
    return positions;
  }

  std::string binary_;
};

}  // namespace pleat
