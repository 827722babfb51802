#include "pleat/formats/edited_motion_file.h"

#include <cassert>
#include <utility>

#include "absl/strings/str_cat.h"
#include "json_depth.h"
#include "motion_json.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr int kMaxEditDepth = 16;
constexpr size_t kMaxEditJoints = 4096;

absl::Status EditFault(const std::string& what) { return absl::InvalidArgumentError(what); }

absl::StatusOr<json> ParseObject(std::string_view text, const MeshLimits& limits) {
  if (text.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the motion file has ", text.size(), " bytes, the limit is ", limits.max_document_bytes));
  }
  if (NestsTooDeep(text, kMaxEditDepth))
    return EditFault("the brackets of the motion nest too deep");
  json root = json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
  if (root.is_discarded() || !root.is_object()) {
    return EditFault("the motion file is not a JSON object");
  }
  return root;
}

absl::StatusOr<std::string> ReadString(const json& object, const char* field) {
  const auto found = object.find(field);
  if (found == object.end() || !found->is_string()) {
    return EditFault(absl::StrCat("field '", field, "' must be a text"));
  }
  return found->get<std::string>();
}

absl::Status ReadJoints(const json& object, MotionEdit* edit) {
  const auto joints = object.find("joints");
  if (joints == object.end() || !joints->is_array() || joints->size() > kMaxEditJoints) {
    return EditFault("field 'joints' must be a list of names");
  }
  for (const json& name : *joints) {
    if (!name.is_string()) return EditFault("field 'joints' must hold names only");
    edit->joints.push_back(name.get<std::string>());
  }
  return absl::OkStatus();
}

absl::Status ReadField(const json& object, const EditField& field, size_t max_length,
                       MotionEdit* edit) {
  const auto found = object.find(std::string(field.name));
  std::vector<double>& numbers = edit->numbers.emplace_back();
  if (found == object.end()) return absl::OkStatus();  // CheckEdit says that it is missing
  if (found->is_number()) {
    numbers.push_back(found->get<double>());
    return absl::OkStatus();
  }
  if (!found->is_array() || found->size() > max_length) {
    return EditFault(absl::StrCat("field '", std::string(field.name),
                                  "' must be a list of at most ", max_length, " numbers"));
  }
  for (const json& value : *found) {
    if (!value.is_number()) {
      return EditFault(absl::StrCat("field '", std::string(field.name), "' must hold numbers"));
    }
    numbers.push_back(value.get<double>());
  }
  return absl::OkStatus();
}

absl::StatusOr<MotionEdit> ReadEdit(const json& object, const MeshLimits& limits) {
  if (!object.is_object()) return EditFault("an edit must be an object");
  PLEAT_ASSIGN_OR_RETURN(const std::string name, ReadString(object, "edit"));
  const EditForm* form = nullptr;
  for (const EditForm& candidate : EditForms()) {
    if (candidate.name == name) form = &candidate;
  }
  if (form == nullptr) {
    return EditFault(absl::StrCat("there is no edit '", EscapeControls(name), "'"));
  }
  MotionEdit edit{.kind = form->kind};
  if (form->has_joints) PLEAT_RETURN_IF_ERROR(ReadJoints(object, &edit));
  if (form->has_other) {
    PLEAT_ASSIGN_OR_RETURN(edit.other, ReadString(object, "motion"));
  }
  for (const EditField& field : form->fields) {
    const auto max_length = static_cast<size_t>(limits.max_vertices);
    PLEAT_RETURN_IF_ERROR(ReadField(object, field, max_length, &edit));
  }
  PLEAT_RETURN_IF_ERROR(CheckEdit(edit));
  return edit;
}

nlohmann::ordered_json EditToJson(const MotionEdit& edit) {
  const EditForm& form = FormOf(edit.kind);
  nlohmann::ordered_json object = {{"edit", form.name}};
  if (form.has_joints) object["joints"] = edit.joints;
  for (size_t f = 0; f < form.fields.size(); ++f) {
    const std::string name(form.fields[f].name);
    if (form.fields[f].count == 1) {
      object[name] = edit.numbers[f][0];
    } else {
      object[name] = edit.numbers[f];
    }
  }
  if (form.has_other) object["motion"] = edit.other;
  return object;
}

absl::StatusOr<Joint> ReadSkeletonJoint(const json& object, size_t index) {
  const auto fault = [&](const char* what) {
    return EditFault(absl::StrCat("skeleton[", index, "]: ", what));
  };
  if (!object.is_object()) return fault("must be an object");
  Joint joint;
  PLEAT_ASSIGN_OR_RETURN(joint.name, ReadString(object, "name"));
  const auto parent = object.find("parent"), rest = object.find("rest_position");
  if (parent == object.end() || !parent->is_number_integer()) return fault("needs 'parent'");
  const int64_t above = parent->get<int64_t>();
  if (above < -1 || above >= static_cast<int64_t>(index)) {
    return fault("'parent' must be the number of an earlier joint, or -1");
  }
  joint.parent = static_cast<int>(above);
  if (rest == object.end() || !rest->is_array() || rest->size() != 3) {
    return fault("needs 'rest_position', three numbers");
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    if (!(*rest)[axis].is_number()) return fault("'rest_position' must hold numbers");
    joint.rest_position[static_cast<Eigen::Index>(axis)] = (*rest)[axis].get<double>();
  }
  return joint;
}

}  // namespace

absl::StatusOr<EditHistory> DecodeEditHistory(std::string_view text, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const json root, ParseObject(text, limits));
  EditHistory history;
  const auto edits = root.find("edits");
  if (edits == root.end()) {
    history.source = text;
    return history;
  }
  PLEAT_ASSIGN_OR_RETURN(history.source, ReadString(root, "source"));
  if (!edits->is_array() || edits->empty()) return EditFault("field 'edits' must list edits");
  if (edits->size() > kMaxEdits) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the motion has ", edits->size(), " edits, the limit is ", kMaxEdits));
  }
  for (size_t i = 0; i < edits->size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(MotionEdit edit, WithContext(absl::StrCat("edits[", i, "]"),
                                                        ReadEdit((*edits)[i], limits)));
    history.edits.push_back(std::move(edit));
  }
  return history;
}

absl::StatusOr<std::optional<Skeleton>> DecodeMotionSkeleton(std::string_view text,
                                                             const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const json root, ParseObject(text, limits));
  const auto list = root.find("skeleton");
  if (list == root.end()) return std::optional<Skeleton>();
  if (!list->is_array() || list->empty() || list->size() > kMaxEditJoints) {
    return EditFault(absl::StrCat("field 'skeleton' must list 1 to ", kMaxEditJoints, " joints"));
  }
  std::vector<Joint> joints;
  for (size_t j = 0; j < list->size(); ++j) {
    PLEAT_ASSIGN_OR_RETURN(Joint joint, ReadSkeletonJoint((*list)[j], j));
    joints.push_back(std::move(joint));
  }
  PLEAT_ASSIGN_OR_RETURN(Skeleton skeleton,
                         WithContext("skeleton", Skeleton::Create(std::move(joints))));
  return std::optional(std::move(skeleton));
}

std::string EncodeEditedMotion(const Skeleton& skeleton, const Motion& motion,
                               const EditHistory& history) {
  assert(!history.edits.empty());
  nlohmann::ordered_json root = MotionToJson(skeleton, motion);
  root["edits"] = nlohmann::ordered_json::array();
  for (const MotionEdit& edit : history.edits) root["edits"].push_back(EditToJson(edit));
  root["source"] = history.source;
  return DumpMotion(root);
}

}  // namespace pleat
