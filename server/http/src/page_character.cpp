#include "page_character.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "pleat/character/option_choices.h"

namespace pleat {
namespace {

constexpr char kMagic[] = {'P', 'L', 'P', 'C'};
constexpr uint32_t kVersion = 1;
constexpr size_t kAlignment = 4;

// Buffers one after the other, and where each begins.
class Buffers {
 public:
  template <typename T>
  void Add(const char* name, const std::vector<T>& values) {
    bytes_.resize((bytes_.size() + kAlignment - 1) / kAlignment * kAlignment, '\0');
    places_[name] = {bytes_.size(), values.size() * sizeof(T)};
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  const nlohmann::ordered_json& places() const { return places_; }
  const std::string& bytes() const { return bytes_; }

 private:
  nlohmann::ordered_json places_;
  std::string bytes_;
};

void AddSkin(const CharacterModel& model, Buffers* buffers) {
  const Rig& rig = model.rig();
  const auto num_vertices = static_cast<size_t>(model.num_vertices());
  std::vector<float> rest(3 * num_vertices), weights(kMaxInfluences * num_vertices);
  std::vector<uint8_t> bones(kMaxInfluences * num_vertices);
  for (size_t v = 0; v < num_vertices; ++v) {
    const VertexInfluences& influences = rig.weights.vertex(static_cast<int>(v));
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      weights[kMaxInfluences * v + k] = influences.weights[k];
      bones[kMaxInfluences * v + k] = static_cast<uint8_t>(influences.bones[k]);
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      rest[3 * v + axis] = static_cast<float>(
          rig.rest_positions(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(v)));
    }
  }
  buffers->Add("rest", rest);
  buffers->Add("bones", bones);
  buffers->Add("weights", weights);
}

// The planes of one part, vertex by vertex: x, y and z of its first plane, of its second, ...
void AppendPlanes(const DetailBasisParameters& basis, std::vector<int8_t>* planes) {
  const auto num_vertices = basis.values.rows() / 3;
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    for (Eigen::Index p = 0; p < basis.values.cols(); ++p) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        planes->push_back(basis.values(3 * v + axis, p));
      }
    }
  }
}

nlohmann::ordered_json AddDetails(const CharacterModel& model, Buffers* buffers) {
  const PartedBasisParameters basis = model.full_basis().parameters();
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  std::vector<uint32_t> vertices;
  std::vector<float> mean;
  std::vector<int8_t> planes;
  for (const PartedBasisParameters::Part& part : basis.parts) {
    const size_t before = vertices.size();
    vertices.insert(vertices.end(), part.vertices.begin(), part.vertices.end());
    if (part.vertices.empty()) {  // the one part of all vertices in their order
      vertices.resize(static_cast<size_t>(model.num_vertices()));
      std::iota(vertices.begin(), vertices.end(), 0u);
    }
    mean.insert(mean.end(), part.basis.mean.begin(), part.basis.mean.end());
    AppendPlanes(part.basis, &planes);
    std::vector<int> coefficients;
    for (const int component : part.basis.components) {
      const auto c = static_cast<size_t>(component);
      coefficients.push_back(part.coefficients.empty() ? component : part.coefficients[c]);
    }
    parts.push_back({{"num_vertices", vertices.size() - before},
                     {"coefficients", coefficients},
                     {"scales", part.basis.scales}});
  }
  buffers->Add("part_vertices", vertices);
  buffers->Add("mean", mean);
  buffers->Add("planes", planes);
  return parts;
}

void AddTriangles(const CharacterModel& model, Buffers* buffers) {
  const Eigen::Matrix3Xi& triangles = model.topology().triangles();
  buffers->Add("triangles",
               std::vector<uint32_t>(triangles.data(), triangles.data() + triangles.size()));
}

}  // namespace

uint64_t PageCharacterBytes(const CharacterModel& model) {
  const auto num_vertices = static_cast<uint64_t>(model.num_vertices());
  constexpr uint64_t kBytesOfVertex =
      2 * 3 * sizeof(float) + kMaxInfluences * (sizeof(float) + 1) + sizeof(uint32_t);
  return num_vertices * kBytesOfVertex + model.full_basis().memory_bytes() +
         static_cast<uint64_t>(model.topology().triangles().size()) * sizeof(uint32_t) +
         (uint64_t{1} << 20);
}

std::string EncodePageCharacter(const CharacterModel& model) {
  Buffers buffers;
  AddSkin(model, &buffers);
  const nlohmann::ordered_json parts = AddDetails(model, &buffers);
  AddTriangles(model, &buffers);
  nlohmann::ordered_json json = {{"num_vertices", model.num_vertices()},
                                 {"num_joints", model.skeleton().num_joints()},
                                 {"num_coefficients", model.full_basis().num_coefficients()},
                                 {"detail_axes", ChoiceName(model.options().detail_axes)},
                                 {"deformation", ChoiceName(model.options().deformation)},
                                 {"parts", parts},
                                 {"buffers", buffers.places()}};
  for (const Joint& joint : model.skeleton().joints()) {
    const Eigen::Vector3d& rest = joint.rest_position;
    json["joints"].push_back({{"parent", joint.parent}, {"rest", {rest.x(), rest.y(), rest.z()}}});
  }
  std::string text = json.dump();
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  const uint32_t head[] = {kVersion, static_cast<uint32_t>(text.size())};
  std::string bytes(kMagic, sizeof(kMagic));
  bytes.append(reinterpret_cast<const char*>(head), sizeof(head));
  return bytes + text + buffers.bytes();
}

}  // namespace pleat
