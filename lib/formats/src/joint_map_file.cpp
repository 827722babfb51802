#include "pleat/formats/joint_map_file.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "json_depth.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr const char* kSchema = "pleat.joint_map/1";
constexpr size_t kMaxMapBytes = 4 << 20, kMaxMapJoints = 4096;
constexpr int kMaxMapDepth = 8;
constexpr double kMinScale = 1e-6, kMaxScale = 1e6;

constexpr std::array<std::string_view, 3> kAlignmentNames = {"direction", "rotation", "sole"};
constexpr std::array<std::string_view, 3> kUpNames = {"auto", "y", "z"};

absl::Status MapFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("joint map: ", what));
}

// Reads a text field that may be absent or null, which leaves *text alone.
absl::Status ReadText(const json& object, const char* field, const std::string& where,
                      std::string* text) {
  const auto found = object.find(field);
  if (found == object.end() || found->is_null()) return absl::OkStatus();
  if (!found->is_string()) return MapFault(absl::StrCat(where, ": '", field, "' must be a text"));
  *text = found->get<std::string>();
  return absl::OkStatus();
}

template <size_t N>
absl::StatusOr<size_t> ReadNamedChoice(const json& object, const char* field,
                                       const std::string& where,
                                       const std::array<std::string_view, N>& names) {
  std::string text(names[0]);
  PLEAT_RETURN_IF_ERROR(ReadText(object, field, where, &text));
  for (size_t i = 0; i < N; ++i) {
    if (names[i] == text) return i;
  }
  std::string known;
  for (const std::string_view name : names) {
    absl::StrAppend(&known, known.empty() ? "" : ", ", std::string(name));
  }
  return MapFault(absl::StrCat(where, ": '", field, "' is '", EscapeControls(text),
                               "'; choose one of ", known));
}

absl::StatusOr<JointMapEntry> ReadEntry(const json& value, size_t index) {
  std::string where = absl::StrCat("joints[", index, "]");
  if (!value.is_object()) return MapFault(absl::StrCat(where, " must be an object"));
  JointMapEntry entry;
  PLEAT_RETURN_IF_ERROR(ReadText(value, "joint", where, &entry.joint));
  if (entry.joint.empty()) {
    return MapFault(absl::StrCat(where, " needs 'joint', a joint of the character"));
  }
  absl::StrAppend(&where, " ('", EscapeControls(entry.joint), "')");
  PLEAT_RETURN_IF_ERROR(ReadText(value, "from", where, &entry.from));
  PLEAT_RETURN_IF_ERROR(ReadText(value, "turns_with", where, &entry.turns_with));
  if (entry.from.empty() && !entry.turns_with.empty()) {
    return MapFault(absl::StrCat(where, " has 'turns_with' and no 'from'"));
  }
  PLEAT_ASSIGN_OR_RETURN(const size_t alignment,
                         ReadNamedChoice(value, "align", where, kAlignmentNames));
  entry.alignment = static_cast<BoneAlignment>(alignment);
  return entry;
}

absl::StatusOr<JointMap> ReadMap(const json& root) {
  if (!root.is_object()) return MapFault("the file must be a JSON object");
  std::string schema;
  PLEAT_RETURN_IF_ERROR(ReadText(root, "schema", "the file", &schema));
  if (schema != kSchema) {
    return MapFault(absl::StrCat("field 'schema' must be \"", kSchema, "\", found '",
                                 EscapeControls(schema), "'"));
  }
  const auto joints = root.find("joints");
  if (joints == root.end() || !joints->is_array()) return MapFault("field 'joints' must be a list");
  if (joints->size() > kMaxMapJoints) {
    return absl::ResourceExhaustedError(
        absl::StrCat("joint map: ", joints->size(), " joints; the limit is ", kMaxMapJoints));
  }
  JointMap map;
  std::set<std::string> seen;
  for (size_t i = 0; i < joints->size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(JointMapEntry entry, ReadEntry((*joints)[i], i));
    if (!seen.insert(entry.joint).second) {
      return MapFault(absl::StrCat("'", EscapeControls(entry.joint), "' is driven twice"));
    }
    map.joints.push_back(std::move(entry));
  }
  PLEAT_ASSIGN_OR_RETURN(const size_t up, ReadNamedChoice(root, "up", "the file", kUpNames));
  map.up = static_cast<ClipUp>(up);
  if (const auto scale = root.find("scale"); scale != root.end() && !scale->is_null()) {
    const double value = scale->is_number() ? scale->get<double>() : 0;
    if (!(value >= kMinScale && value <= kMaxScale)) {
      return MapFault(absl::StrCat("field 'scale' must be a number from ", kMinScale, " to ",
                                   kMaxScale, ", or null: by the lengths of the legs"));
    }
    map.scale = value;
  }
  const auto left_out = root.find("left_out");
  if (left_out == root.end() || !left_out->is_array()) return map;
  for (const json& name : *left_out) {
    if (name.is_string() && map.left_out.size() < kMaxMapJoints) {
      map.left_out.push_back(name.get<std::string>());
    }
  }
  return map;
}

}  // namespace

std::string_view BoneAlignmentName(BoneAlignment alignment) {
  return kAlignmentNames[static_cast<size_t>(alignment)];
}

std::string_view ClipUpName(ClipUp axis) { return kUpNames[static_cast<size_t>(axis)]; }

absl::StatusOr<JointMap> DecodeJointMap(std::string_view text) {
  if (text.size() > kMaxMapBytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("joint map: ", text.size(), " bytes; the limit is ", kMaxMapBytes));
  }
  if (NestsTooDeep(text, kMaxMapDepth)) return MapFault("its brackets nest too deep");
  const json root = json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
  if (root.is_discarded()) return MapFault("the file is not JSON");
  return ReadMap(root);
}

absl::StatusOr<JointMap> ReadJointMap(const std::string& path) {
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxMapBytes));
  return WithContext(path, DecodeJointMap(text));
}

std::string EncodeJointMap(const JointMap& map) {
  nlohmann::ordered_json root;
  root["schema"] = kSchema;
  root["up"] = ClipUpName(map.up);
  root["scale"] = nullptr;
  if (map.scale) root["scale"] = *map.scale;
  root["joints"] = nlohmann::ordered_json::array();
  for (const JointMapEntry& entry : map.joints) {
    nlohmann::ordered_json object = {{"joint", entry.joint}, {"from", nullptr}};
    if (!entry.from.empty()) {
      object["from"] = entry.from;
      object["turns_with"] = entry.turns_with;
      object["align"] = BoneAlignmentName(entry.alignment);
    }
    root["joints"].push_back(std::move(object));
  }
  root["left_out"] = map.left_out;
  return root.dump(1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

absl::Status WriteJointMap(const std::string& path, const JointMap& map) {
  return WriteFile(path, EncodeJointMap(map));
}

}  // namespace pleat
