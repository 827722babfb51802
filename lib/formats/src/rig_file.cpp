#include "pleat/formats/rig_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "gltf_file.h"
#include "json_depth.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr const char* kRigSchema = "pleat.rig_file/1";
constexpr int kMaxFrame = 100'000;
constexpr int kMaxListedInfluences = 64;  // influences of one vertex
constexpr int kMaxRigDepth = 16;          // nested brackets in the JSON

absl::Status RigFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("rig: ", what));
}

class RigParser {
 public:
  RigParser(const json& root, const MeshLimits& limits) : root_(root), limits_(limits) {}

  absl::StatusOr<RigFile> Parse() {
    if (!root_.is_object()) return RigFault("the file is not a JSON object");
    if (root_.value("schema", json()) != kRigSchema) {
      return RigFault(absl::StrCat("field 'schema' must be \"", kRigSchema, "\""));
    }
    PLEAT_RETURN_IF_ERROR(ParseJoints());
    PLEAT_RETURN_IF_ERROR(ParseWeights());
    if (const auto frame = root_.find("rest_frame"); frame != root_.end()) {
      if (!frame->is_number_integer() || *frame < 0 || *frame > kMaxFrame) {
        return RigFault("'rest_frame' must be a frame number of the first clip");
      }
      file_.rest_frame = frame->get<int>();
    }
    PLEAT_RETURN_IF_ERROR(ParseLocks());
    return std::move(file_);
  }

 private:
  absl::Status ParseJoints() {
    const auto list = root_.find("joints");
    if (list == root_.end() || !list->is_array() || list->size() < 2 ||
        list->size() > kMaxUserJoints) {
      return RigFault(absl::StrCat("'joints' must list 2 to ", kMaxUserJoints, " joints"));
    }
    std::vector<Joint> joints;
    for (const json& entry : *list) {
      PLEAT_ASSIGN_OR_RETURN(Joint joint, ParseJoint(entry, joints));
      joints.push_back(std::move(joint));
    }
    absl::StatusOr<Skeleton> skeleton = Skeleton::Create(std::move(joints));
    if (!skeleton.ok()) return RigFault(std::string(skeleton.status().message()));
    file_.skeleton = *std::move(skeleton);
    return absl::OkStatus();
  }

  static absl::StatusOr<Joint> ParseJoint(const json& entry, const std::vector<Joint>& before) {
    const std::string where = absl::StrCat("joint ", before.size());
    const auto name = entry.is_object() ? entry.find("name") : entry.end();
    if (!entry.is_object() || name == entry.end() || !name->is_string()) {
      return RigFault(absl::StrCat(where, " has no name"));
    }
    Joint joint;
    joint.name = name->get<std::string>();
    const auto parent = entry.find("parent");
    if (parent == entry.end() || parent->is_null()) {
      joint.parent = -1;
    } else if (parent->is_string()) {
      const auto found = std::ranges::find(before, parent->get<std::string>(), &Joint::name);
      if (found == before.end()) {
        return RigFault(absl::StrCat(where, " ('", joint.name, "'): its parent '",
                                     parent->get<std::string>(), "' is not listed before it"));
      }
      joint.parent = static_cast<int>(found - before.begin());
    } else if (parent->is_number_integer() && *parent >= -1 &&
               *parent < static_cast<int64_t>(before.size())) {
      joint.parent = parent->get<int>();
    } else {
      return RigFault(absl::StrCat(where, " ('", joint.name,
                                   "'): 'parent' must name a joint listed before it, by name or "
                                   "index; -1 or nothing for the root"));
    }
    const auto position = entry.find("position_m");
    if (position == entry.end() || !position->is_array() || position->size() != 3) {
      return RigFault(absl::StrCat(where, " ('", joint.name, "') needs a position_m [x, y, z]"));
    }
    for (int k = 0; k < 3; ++k) {
      const json& value = (*position)[k];
      joint.rest_position[k] = value.is_number() ? value.get<double>() : std::nan("");
      if (!std::isfinite(joint.rest_position[k])) {
        return RigFault(absl::StrCat(where, " ('", joint.name, "'): position_m is not finite"));
      }
    }
    return joint;
  }

  absl::Status ParseLocks() {
    if (const auto locked = root_.find("locked"); locked != root_.end()) {
      if (!locked->is_boolean()) return RigFault("'locked' must be true or false");
      file_.is_locked = locked->get<bool>();
    }
    const json& joints = root_["joints"];
    for (size_t j = 0; j < joints.size(); ++j) {
      const auto locked = joints[j].find("locked");
      if (locked == joints[j].end()) continue;
      if (!locked->is_boolean()) {
        return RigFault(absl::StrCat("joint ", j, ": 'locked' must be true or false"));
      }
      if (locked->get<bool>()) file_.locked_joints.push_back(static_cast<int>(j));
    }
    return absl::OkStatus();
  }

  absl::Status ParseWeights() {
    const auto weights = root_.find("weights");
    if (weights == root_.end()) return absl::OkStatus();
    if (!weights->is_object()) return RigFault("'weights' must be an object");
    const json of = weights->value("of", json("joints"));
    if (of != "joints" && of != "bones") {
      return RigFault("'weights.of' must be \"joints\" or \"bones\"");
    }
    file_.influences_are_of_bones = of == "bones";
    const auto vertices = weights->find("vertices");
    if (vertices == weights->end() || !vertices->is_array() || vertices->empty()) {
      return RigFault("'weights.vertices' must hold one list for every vertex");
    }
    if (static_cast<int64_t>(vertices->size()) > limits_.max_vertices) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "rig: weights of ", vertices->size(), " vertices; the limit is ", limits_.max_vertices));
    }
    file_.influences.reserve(vertices->size());
    for (const json& vertex : *vertices) {
      PLEAT_ASSIGN_OR_RETURN(std::vector<JointInfluence> influences, ParseVertex(vertex));
      file_.influences.push_back(std::move(influences));
    }
    return absl::OkStatus();
  }

  // Reads the list of one vertex: [joint, weight, joint, weight, ...].
  absl::StatusOr<std::vector<JointInfluence>> ParseVertex(const json& vertex) const {
    const size_t v = file_.influences.size();
    if (!vertex.is_array() || vertex.size() % 2 != 0 || vertex.size() > 2 * kMaxListedInfluences) {
      return RigFault(absl::StrCat("vertex ", v,
                                   ": its weights must be a list joint, weight, ... of "
                                   "at most ",
                                   kMaxListedInfluences, " pairs"));
    }
    std::vector<JointInfluence> influences;
    for (size_t k = 0; k < vertex.size(); k += 2) {
      const json &joint = vertex[k], &weight = vertex[k + 1];
      if (!joint.is_number_integer() || joint < 0 || joint >= file_.skeleton.num_joints() ||
          !weight.is_number() || !(weight.get<double>() >= 0) ||
          !std::isfinite(weight.get<double>())) {
        return RigFault(absl::StrCat("vertex ", v, ", pair ", k / 2,
                                     ": must be the index of a joint and a weight of at least 0"));
      }
      influences.push_back({joint.get<int>(), weight.get<double>()});
    }
    return influences;
  }

  const json& root_;
  const MeshLimits& limits_;
  RigFile file_;
};

// Returns the double whose shortest decimal text is that of the float. The file then has half as
// many digits, and reading it gives the same float.
double ShortDecimal(float value) {
  char text[32];
  const auto written = std::to_chars(text, text + sizeof(text), value);
  double decimal = value;
  std::from_chars(text, written.ptr, decimal);
  return static_cast<float>(decimal) == value ? decimal : value;
}

}  // namespace

absl::StatusOr<RigFile> DecodeRigJson(std::string_view text, const MeshLimits& limits) {
  if (text.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("rig: ", text.size(), " bytes; the limit is ", limits.max_document_bytes));
  }
  if (NestsTooDeep(text, kMaxRigDepth))
    return RigFault(absl::StrCat("nested deeper than ", kMaxRigDepth, " levels"));
  const json root = json::parse(text, nullptr, false);
  if (root.is_discarded()) return RigFault("the file is not JSON");
  return RigParser(root, limits).Parse();
}

absl::Status LockJoints(const std::vector<std::string>& names, RigFile* file) {
  std::set<int> locked(file->locked_joints.begin(), file->locked_joints.end());
  for (const std::string& name : names) {
    const int joint = file->skeleton.FindJoint(name);
    if (joint < 0) return RigFault(absl::StrCat("there is no joint '", name, "' to lock"));
    locked.insert(joint);
  }
  file->locked_joints.assign(locked.begin(), locked.end());
  return absl::OkStatus();
}

absl::StatusOr<RigFile> ReadRigFile(const std::string& path, const MeshLimits& limits,
                                    std::string_view skin) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_document_bytes));
  if (std::string_view(bytes).starts_with("glTF")) {
    return WithContext(path, DecodeRigGlb(bytes, limits, skin));
  }
  PLEAT_RETURN_IF_ERROR(RefuseForeignBytes(bytes, path));
  const std::string ending = absl::AsciiStrToLower(path);
  if (absl::EndsWith(ending, ".gltf") || IsGltfText(bytes)) {
    absl::StatusOr<std::string> packed = PackGltf(bytes, path, limits);
    if (!packed.ok()) return WithContext(path, packed.status());
    absl::StatusOr<RigFile> rig = DecodeRigGlb(*packed, limits, skin);
    if (rig.ok()) return rig;
    return absl::Status(rig.status().code(),
                        absl::StrCat(path, ": ", rig.status().message(),
                                     " (glTF text is read with the buffers beside it; export as "
                                     "GLB to have mesh and skeleton in one file)"));
  }
  if (absl::EndsWith(ending, ".glb")) {
    return WithContext(path, DecodeRigGlb(bytes, limits, skin));
  }
  if (!skin.empty())
    return WithContext(path, RigFault("only GLB and glTF have skins to choose from"));
  return WithContext(path, DecodeRigJson(bytes, limits));
}

std::string EncodeRig(const UserRig& rig) {
  nlohmann::ordered_json root;
  root["schema"] = kRigSchema;
  root["rest_frame"] = rig.rest_frame;
  for (const Joint& joint : rig.skeleton.joints()) {
    const Eigen::Vector3d& p = joint.rest_position;
    root["joints"].push_back(
        {{"name", joint.name}, {"parent", joint.parent}, {"position_m", {p.x(), p.y(), p.z()}}});
  }
  for (const int joint : rig.locked_joints) root["joints"][joint]["locked"] = true;
  if (rig.weights) {
    root["weights"]["of"] = "bones";
    nlohmann::ordered_json& vertices = root["weights"]["vertices"];
    vertices = nlohmann::ordered_json::array();
    for (const VertexInfluences& vertex : rig.weights->influences()) {
      nlohmann::ordered_json list = nlohmann::ordered_json::array();
      for (int k = 0; k < kMaxInfluences && vertex.weights[k] > 0; ++k) {
        list.push_back(vertex.bones[k]);
        list.push_back(ShortDecimal(vertex.weights[k]));
      }
      vertices.push_back(std::move(list));
    }
  }
  return root.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace pleat
