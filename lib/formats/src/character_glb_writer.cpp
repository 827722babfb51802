// Khronos, glTF 2.0 specification, sections 3.7.3 (skins), 3.7.2.2 (morph targets) and 3.11
// (animations).
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "export_skin.h"
#include "glb_buffers.h"
#include "glb_primitives.h"
#include "pleat/base/file_parts.h"
#include "pleat/base/status.h"
#include "pleat/formats/character_file.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/mesh/normals.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr int kMeshNode = 0, kFirstJointNode = 1;

json Numbers(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// Of unit length; up where a vertex has no triangle.
Eigen::Matrix3Xf UnitNormals(const Eigen::Matrix3Xd& positions, const Topology& topology) {
  Eigen::Matrix3Xd normals = SumTriangleNormals(positions, topology.triangles());
  for (Eigen::Index v = 0; v < normals.cols(); ++v) {
    const double length = normals.col(v).norm();
    if (length > 0) {
      normals.col(v) /= length;
    } else {
      normals.col(v) = Eigen::Vector3d::UnitY();
    }
  }
  return normals.cast<float>();
}

class CharacterGlb {
 public:
  explicit CharacterGlb(const CharacterFile& character)
      : character_(character),
        mesh_(character.topology, character.appearance),
        joints_(MakeExportJoints(character.rig.skeleton)),
        clip_(ClipFromPoses(character.rig.skeleton, character.track)) {}

  absl::StatusOr<std::string> Encode(std::string* binary) {
    const uint64_t num_bytes = NumBytes();
    if (num_bytes > kMaxGlbBinaryBytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat(num_targets(), " morph targets of ", mesh_.num_vertices(), " vertices and ",
                       clip_.num_frames(), " frames of ", joints_.size(), " joints are ", num_bytes,
                       " bytes, more than a GLB can hold; ask for fewer targets"));
    }
    buffers_ = GlbBuffers(num_bytes);
    const json attributes = Attributes();
    const json targets = Targets();
    json mesh = {{"name", character_.name},
                 {"primitives", mesh_.Primitives(attributes, targets, &buffers_)}};
    if (num_targets() > 0) {
      mesh["weights"] = std::vector<int>(num_targets(), 0);
      mesh["extras"] = {{"targetNames", TargetNames()}};
    }
    json root = {{"asset", {{"version", "2.0"}, {"generator", "Pleat"}}},
                 {"scene", 0},
                 {"scenes", json::array({{{"nodes", {kMeshNode, kFirstJointNode}}}})},
                 {"nodes", Nodes()},
                 {"meshes", json::array({std::move(mesh)})},
                 {"skins", json::array({Skin()})}};
    AddGlbMaterials(character_.appearance, &root);
    if (character_.track.num_frames() > 0) root["animations"] = json::array({Animation()});
    return buffers_.Finish(std::move(root), binary);
  }

 private:
  size_t num_targets() const {
    return character_.morphs ? static_cast<size_t>(character_.morphs->targets.cols()) : 0;
  }

  uint64_t NumBytes() const {
    constexpr uint64_t kVertexBytes = 12 + 12 + 8 + 4, kSetBytes = 8 + 16, kTargetBytes = 24;
    const uint64_t vertex_bytes =
        kVertexBytes + kSetBytes * NumSets() + kTargetBytes * num_targets();
    const uint64_t frame_bytes = 4 + 12 + 16 * joints_.size() + 4 * num_targets();
    return mesh_.num_vertices() * vertex_bytes + mesh_.num_triangles() * 12 +
           clip_.num_frames() * frame_bytes + joints_.size() * 64;
  }

  size_t NumSets() const {
    return (static_cast<size_t>(MostInfluences(character_.rig.weights)) + 3) / 4;
  }

  json Attributes() {
    const Eigen::Matrix3Xd& rest = character_.rig.rest_positions;
    json attributes = {
        {"POSITION", buffers_.AddPoints(mesh_.Spread(rest.cast<float>()))},
        {"NORMAL", buffers_.AddVectors(mesh_.Spread(UnitNormals(rest, character_.topology)))}};
    mesh_.AddTexcoords(&buffers_, &attributes);
    mesh_.AddVertexIds(&buffers_, &attributes);
    const std::vector<ExportInfluences> influences =
        MakeExportInfluences(character_.rig.weights, joints_);
    for (size_t set = 0; set < NumSets(); ++set) {
      std::vector<uint16_t> joints;
      std::vector<float> weights;
      for (const int32_t source : mesh_.sources()) {
        const ExportInfluences& vertex = influences[static_cast<size_t>(source)];
        for (size_t k = 4 * set; k < 4 * set + 4; ++k) {
          const bool is_there = k < kMaxInfluences;
          joints.push_back(is_there ? vertex.joints[k] : uint16_t{0});
          weights.push_back(is_there ? vertex.weights[k] : 0.f);
        }
      }
      attributes[absl::StrCat("JOINTS_", set)] = buffers_.Add(joints, "VEC4", 4, kVertexBuffer);
      attributes[absl::StrCat("WEIGHTS_", set)] = buffers_.Add(weights, "VEC4", 4, kVertexBuffer);
    }
    return attributes;
  }

  // Differences of positions, and of the normals that the mesh has with the whole target.
  json Targets() {
    if (num_targets() == 0) return {};
    const Eigen::Matrix3Xd& rest = character_.rig.rest_positions;
    const Eigen::Matrix3Xf normals = UnitNormals(rest, character_.topology);
    json targets = json::array();
    for (size_t k = 0; k < num_targets(); ++k) {
      const Eigen::Matrix3Xf difference =
          character_.morphs->targets.col(static_cast<Eigen::Index>(k)).reshaped(3, rest.cols());
      const Eigen::Matrix3Xf turned =
          UnitNormals(rest + difference.cast<double>(), character_.topology) - normals;
      targets.push_back({{"POSITION", buffers_.AddPoints(mesh_.Spread(difference))},
                         {"NORMAL", buffers_.AddVectors(mesh_.Spread(turned))}});
    }
    return targets;
  }

  json TargetNames() const {
    json names = json::array({"base_folds"});
    for (size_t k = 1; k < num_targets(); ++k) names.push_back(absl::StrCat("folds_", k));
    return names;
  }

  // At rest all joints have the axes of the world.
  json Nodes() const {
    json nodes = json::array({{{"name", character_.name}, {"mesh", 0}, {"skin", 0}}});
    for (const ClipJoint& joint : clip_.joints) {
      nodes.push_back({{"name", joint.name}, {"translation", Numbers(joint.offset)}});
    }
    for (size_t e = 1; e < joints_.size(); ++e) {
      nodes[static_cast<size_t>(kFirstJointNode + joints_[e].parent)]["children"].push_back(
          kFirstJointNode + static_cast<int>(e));
    }
    return nodes;
  }

  json Skin() {
    std::vector<int> nodes;
    std::vector<float> inverse_binds;
    for (size_t e = 0; e < joints_.size(); ++e) {
      nodes.push_back(kFirstJointNode + static_cast<int>(e));
      Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
      matrix.topRightCorner<3, 1>() = -joints_[e].rest_position.cast<float>();
      inverse_binds.insert(inverse_binds.end(), matrix.data(), matrix.data() + 16);
    }
    return {{"name", character_.name},
            {"joints", nodes},
            {"skeleton", kFirstJointNode},
            {"inverseBindMatrices", buffers_.Add(inverse_binds, "MAT4", 16, kNoBufferTarget)}};
  }

  json Animation() {
    std::vector<float> times;
    for (size_t t = 0; t < clip_.num_frames(); ++t) {
      times.push_back(static_cast<float>(static_cast<double>(t) / character_.frame_rate.fps()));
    }
    input_ = buffers_.Add(times, "SCALAR", 1, kNoBufferTarget);
    buffers_.SetRange(input_, times.front(), times.back());
    std::vector<float> places;
    for (size_t t = 0; t < clip_.num_frames(); ++t) {
      const Eigen::Vector3f place = clip_.translations[t * joints_.size()].cast<float>();
      places.insert(places.end(), place.data(), place.data() + 3);
    }
    AddChannel(kFirstJointNode, "translation", buffers_.Add(places, "VEC3", 3, kNoBufferTarget));
    for (size_t e = 0; e < joints_.size(); ++e) {
      if (joints_[e].turning_bone < 0) continue;
      AddChannel(kFirstJointNode + static_cast<int>(e), "rotation",
                 buffers_.Add(Rotations(e), "VEC4", 4, kNoBufferTarget));
    }
    if (num_targets() > 0) {
      const Eigen::MatrixXf by_frame = character_.morphs->weights.transpose();
      const std::span<const float> values(by_frame.data(), static_cast<size_t>(by_frame.size()));
      AddChannel(kMeshNode, "weights", buffers_.Add(values, "SCALAR", 1, kNoBufferTarget));
    }
    const FrameRate rate = character_.frame_rate;
    return {{"name", character_.name},
            {"extras", {{"frame_rate", {rate.numerator, rate.denominator}}}},
            {"samplers", std::move(samplers_)},
            {"channels", std::move(channels_)}};
  }

  // x, y, z, w of all frames, with signs that do not jump: some programs blend them as numbers.
  std::vector<float> Rotations(size_t joint) const {
    std::vector<float> rotations;
    Eigen::Vector4d previous = Eigen::Vector4d::UnitW();
    for (size_t t = 0; t < clip_.num_frames(); ++t) {
      Eigen::Vector4d rotation = clip_.rotations[t * joints_.size() + joint].normalized().coeffs();
      if (rotation.dot(previous) < 0) rotation = -rotation;
      previous = rotation;
      for (int k = 0; k < 4; ++k) rotations.push_back(static_cast<float>(rotation[k]));
    }
    return rotations;
  }

  void AddChannel(int node, const char* path, size_t output) {
    channels_.push_back(
        {{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers_.push_back({{"input", input_}, {"output", output}, {"interpolation", "LINEAR"}});
  }

  const CharacterFile& character_;
  const GlbPrimitives mesh_;
  const std::vector<ExportJoint> joints_;
  const JointClip clip_;
  GlbBuffers buffers_{0};
  size_t input_ = 0;  // the accessor of the times
  json samplers_ = json::array(), channels_ = json::array();
};

}  // namespace

absl::StatusOr<std::string> EncodeCharacterGlb(const CharacterFile& character) {
  std::string binary;
  PLEAT_ASSIGN_OR_RETURN(const std::string start, CharacterGlb(character).Encode(&binary));
  return start + binary;
}

absl::Status WriteCharacterGlb(const std::string& path, const CharacterFile& character) {
  std::string binary;
  PLEAT_ASSIGN_OR_RETURN(const std::string start, CharacterGlb(character).Encode(&binary));
  const std::string_view parts[] = {start, binary};
  return WriteFileParts(path, parts);
}

}  // namespace pleat
