#include "pleat/formats/motion_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "motion_json.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr const char* kMotionSchema = "pleat.motion/1";
constexpr double kMaxMotionFps = 1000;
constexpr double kMaxDetailStrength = 2;
constexpr double kNormTolerance = 0.01;  // normalizing by more than this is worth a warning

absl::Status MotionFault(const std::string& what) { return absl::InvalidArgumentError(what); }

std::string KnownJoints(const Skeleton& skeleton) {
  return absl::StrJoin(skeleton.joints(), ", ",
                       [](std::string* out, const Joint& joint) { out->append(joint.name); });
}

absl::StatusOr<int> FindJoint(const Skeleton& skeleton, const std::string& name,
                              absl::string_view where) {
  const int joint = skeleton.FindJoint(name);
  if (joint >= 0) return joint;
  return MotionFault(absl::StrCat(where, ": the character has no joint '", name,
                                  "'; its joints are ", KnownJoints(skeleton)));
}

// Fills `numbers` from a JSON array of exactly that many finite numbers.
absl::Status ReadMotionNumbers(const json& value, const std::string& where,
                               std::span<double> numbers) {
  if (!value.is_array() || value.size() != numbers.size()) {
    return MotionFault(absl::StrCat(where, " must be a list of ", numbers.size(), " numbers"));
  }
  for (size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = value[i].is_number() ? value[i].get<double>() : std::nan("");
    if (!std::isfinite(numbers[i])) {
      return MotionFault(absl::StrCat(where, ", entry ", i, " is not a finite number"));
    }
  }
  return absl::OkStatus();
}

// Reads the parsed JSON of a motion. The frames come in one of two forms: a list "frames", or the
// two columns "root_translation" and "rotations". Joints that the file does not name stay at rest.
// What a reader can repair becomes a warning; everything else is an error that says where it is.
class MotionParser {
 public:
  MotionParser(const json& root, const Skeleton& skeleton, const MeshLimits& limits)
      : root_(root), skeleton_(skeleton), limits_(limits) {}

  absl::StatusOr<Motion> Parse() {
    if (!root_.is_object()) return MotionFault("a motion file must be a JSON object");
    const auto schema = root_.find("schema");
    if (schema == root_.end() || *schema != kMotionSchema) {
      return MotionFault(absl::StrCat("field 'schema' must be \"", kMotionSchema, "\", found ",
                                      schema == root_.end() ? "none" : Excerpt(*schema)));
    }
    PLEAT_RETURN_IF_ERROR(ParseFps());
    PLEAT_RETURN_IF_ERROR(ParseJoints());
    PLEAT_RETURN_IF_ERROR(ParseFrames());
    PLEAT_RETURN_IF_ERROR(ParseBoneScales());
    PLEAT_RETURN_IF_ERROR(ParseStrengths());
    PLEAT_RETURN_IF_ERROR(ParseClipStarts());
    Warn();
    PLEAT_ASSIGN_OR_RETURN(motion_.track, PoseTrack::Create(std::move(track_)));
    return std::move(motion_);
  }

 private:
  static std::string Excerpt(const json& value) {
    return value.dump(-1, ' ', true, json::error_handler_t::replace).substr(0, 40);
  }

  absl::Status ParseFps() {
    const auto fps = root_.find("fps");
    const double value = fps != root_.end() && fps->is_number() ? fps->get<double>() : 0;
    if (!(value > 0 && value <= kMaxMotionFps)) {
      return MotionFault(absl::StrCat("field 'fps' must be a number above 0 and at most ",
                                      kMaxMotionFps, fps == root_.end() ? "; it is missing" : ""));
    }
    track_.fps = value;
    return absl::OkStatus();
  }

  absl::Status ParseJoints() {
    const auto joints = root_.find("joints");
    if (joints == root_.end() || !joints->is_array() || joints->empty()) {
      return MotionFault(absl::StrCat("field 'joints' must list joint names; the character has ",
                                      KnownJoints(skeleton_)));
    }
    std::set<int> seen;
    for (const json& name : *joints) {
      if (!name.is_string()) return MotionFault("field 'joints' must hold names only");
      PLEAT_ASSIGN_OR_RETURN(const int joint,
                             FindJoint(skeleton_, name.get<std::string>(), "joints"));
      if (!seen.insert(joint).second) {
        return MotionFault(absl::StrCat("joints: '", name.get<std::string>(), "' is listed twice"));
      }
      columns_.push_back(joint);
    }
    for (int j = 0; j < skeleton_.num_joints(); ++j) {
      if (!seen.contains(j)) resting_.push_back(skeleton_.joint(j).name);
    }
    return absl::OkStatus();
  }

  absl::Status ParseFrames() {
    const auto frames = root_.find("frames");
    const auto translations = root_.find("root_translation");
    const auto rotations = root_.find("rotations");
    const bool has_columns = translations != root_.end() && rotations != root_.end();
    if ((frames != root_.end()) == has_columns) {
      return MotionFault(
          "a motion needs either 'frames' or both 'root_translation' and 'rotations'");
    }
    const json& list = has_columns ? *translations : *frames;
    if (!list.is_array() || list.empty()) return MotionFault("the motion has no frames");
    if (static_cast<int64_t>(list.size()) > limits_.max_frames) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "the motion has ", list.size(), " frames, the limit is ", limits_.max_frames));
    }
    if (has_columns && (!rotations->is_array() || rotations->size() != list.size())) {
      return MotionFault(absl::StrCat("'rotations' must have one entry for each of the ",
                                      list.size(), " frames of 'root_translation'"));
    }
    track_.poses.reserve(list.size());
    for (size_t t = 0; t < list.size(); ++t) {
      if (has_columns) {
        PLEAT_RETURN_IF_ERROR(ParsePose(t, list[t], (*rotations)[t]));
        continue;
      }
      if (!list[t].is_object() || !list[t].contains("root_translation") ||
          !list[t].contains("rotations")) {
        return MotionFault(absl::StrCat("frame ", t, " needs 'root_translation' and 'rotations'"));
      }
      PLEAT_RETURN_IF_ERROR(ParsePose(t, list[t]["root_translation"], list[t]["rotations"]));
    }
    return absl::OkStatus();
  }

  absl::Status ParsePose(size_t t, const json& translation, const json& rotations) {
    Pose pose = Pose::Rest(skeleton_);
    PLEAT_RETURN_IF_ERROR(ReadMotionNumbers(translation,
                                            absl::StrCat("frame ", t, ", root_translation"),
                                            std::span(pose.root_position.data(), 3)));
    if (!rotations.is_array() || rotations.size() != columns_.size()) {
      return MotionFault(absl::StrCat("frame ", t, " has ",
                                      rotations.is_array() ? rotations.size() : 0,
                                      " rotations, 'joints' lists ", columns_.size()));
    }
    for (size_t i = 0; i < columns_.size(); ++i) {
      const std::string& name = skeleton_.joint(columns_[i]).name;
      const std::string where = absl::StrCat("frame ", t, ", rotation of '", name, "'");
      std::array<double, 4> wxyz;
      PLEAT_RETURN_IF_ERROR(ReadMotionNumbers(rotations[i], where, wxyz));
      const double norm = std::hypot(std::hypot(wxyz[0], wxyz[1]), std::hypot(wxyz[2], wxyz[3]));
      if (!(norm > 1e-6) || !std::isfinite(norm)) {
        return MotionFault(absl::StrCat(where, " has length ", norm,
                                        "; a rotation is a quaternion w, x, y, z of length 1"));
      }
      num_rescaled_ += std::abs(norm - 1) > kNormTolerance;
      pose.rotations[columns_[i]] =
          Eigen::Quaterniond(wxyz[0] / norm, wxyz[1] / norm, wxyz[2] / norm, wxyz[3] / norm);
    }
    track_.poses.push_back(std::move(pose));
    return absl::OkStatus();
  }

  absl::Status ParseBoneScales() {
    const auto scales = root_.find("bone_scales");
    if (scales == root_.end()) return absl::OkStatus();
    if (!scales->is_object())
      return MotionFault("field 'bone_scales' must map joint names to factors");
    motion_.bone_scales.assign(static_cast<size_t>(skeleton_.num_joints()), 1.0);
    for (const auto& [name, value] : scales->items()) {
      PLEAT_ASSIGN_OR_RETURN(const int joint, FindJoint(skeleton_, name, "bone_scales"));
      const double factor = value.is_number() ? value.get<double>() : 0;
      if (!(factor > 0) || !std::isfinite(factor)) {
        return MotionFault(absl::StrCat("bone_scales: the factor of '", name, "' must be above 0"));
      }
      motion_.bone_scales[static_cast<size_t>(joint)] = factor;
    }
    return absl::OkStatus();
  }

  absl::Status ParseStrengths() {
    const auto named = root_.find("detail_strengths");
    if (named != root_.end()) {
      if (!named->is_object())
        return MotionFault("field 'detail_strengths' must map joints to factors");
      motion_.detail_strengths.assign(static_cast<size_t>(skeleton_.num_joints()), 1.0);
      for (const auto& [name, value] : named->items()) {
        PLEAT_ASSIGN_OR_RETURN(const int joint, FindJoint(skeleton_, name, "detail_strengths"));
        PLEAT_ASSIGN_OR_RETURN(motion_.detail_strengths[static_cast<size_t>(joint)],
                               ReadStrength(value, absl::StrCat("detail_strengths: '", name, "'")));
      }
    }
    const auto painted = root_.find("vertex_strengths");
    if (painted == root_.end()) return absl::OkStatus();
    if (!painted->is_array())
      return MotionFault("field 'vertex_strengths' must be a list of factors");
    if (static_cast<int64_t>(painted->size()) > limits_.max_vertices) {
      return absl::ResourceExhaustedError(absl::StrCat("vertex_strengths has ", painted->size(),
                                                       " entries, the limit is ",
                                                       limits_.max_vertices));
    }
    for (size_t v = 0; v < painted->size(); ++v) {
      PLEAT_ASSIGN_OR_RETURN(
          const double strength,
          ReadStrength((*painted)[v], absl::StrCat("vertex_strengths[", v, "]")));
      motion_.vertex_strengths.push_back(static_cast<float>(strength));
    }
    return absl::OkStatus();
  }

  static absl::StatusOr<double> ReadStrength(const json& value, const std::string& where) {
    const double strength = value.is_number() ? value.get<double>() : -1;
    if (strength >= 0 && strength <= kMaxDetailStrength) return strength;
    return MotionFault(absl::StrCat(where, " must be a factor from 0 to ", kMaxDetailStrength));
  }

  absl::Status ParseClipStarts() {
    const auto starts = root_.find("clip_starts");
    if (starts == root_.end()) return absl::OkStatus();
    track_.clip_starts.clear();
    for (const json& value : starts->is_array() ? *starts : json::array()) {
      const int64_t start = value.is_number_integer() ? value.get<int64_t>() : -1;
      if (start < 0 || start > std::numeric_limits<int>::max()) break;
      track_.clip_starts.push_back(static_cast<int>(start));
    }
    if (!starts->is_array() || track_.clip_starts.size() != starts->size()) {
      return MotionFault(
          "field 'clip_starts' must list ascending frame numbers of the motion from 0");
    }
    return absl::OkStatus();
  }

  void Warn() {
    if (!resting_.empty()) {
      motion_.warnings.push_back(absl::StrCat("joints that the motion does not name stay at rest: ",
                                              absl::StrJoin(resting_, ", ")));
    }
    if (num_rescaled_ > 0) {
      motion_.warnings.push_back(
          absl::StrCat(num_rescaled_, " rotations were not of length 1 and were normalized"));
    }
    static const std::set<std::string> kFields = {"schema",
                                                  "fps",
                                                  "joints",
                                                  "frames",
                                                  "root_translation",
                                                  "rotations",
                                                  "bone_scales",
                                                  "detail_strengths",
                                                  "vertex_strengths",
                                                  "clip_starts",
                                                  "skeleton",
                                                  "edits",
                                                  "source"};
    for (const auto& [name, value] : root_.items()) {
      if (kFields.contains(name)) continue;
      motion_.warnings.push_back(
          absl::StrCat("the unknown field ", Excerpt(json(name)), " is ignored"));
      if (motion_.warnings.size() > 20) break;
    }
  }

  const json& root_;
  const Skeleton& skeleton_;
  const MeshLimits& limits_;
  std::vector<int> columns_;          // the skeleton's joint for every rotation of a frame
  std::vector<std::string> resting_;  // joints that the file does not name
  int64_t num_rescaled_ = 0;
  PoseTrack::Parts track_;
  Motion motion_;
};

}  // namespace

absl::StatusOr<Motion> DecodeMotion(std::string_view text, const Skeleton& skeleton,
                                    const MeshLimits& limits) {
  if (text.empty()) return MotionFault("the motion file is empty");
  if (text.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the motion file has ", text.size(), " bytes, the limit is ", limits.max_document_bytes));
  }
  json root;
  try {  // the parser says where it stopped only in its exception
    root = json::parse(text.begin(), text.end());
  } catch (const json::parse_error& fault) {
    const std::string_view before = text.substr(0, std::max<size_t>(fault.byte, 1) - 1);
    const size_t line_begin = before.rfind('\n') + 1;  // 0 when there is no line break
    return MotionFault(absl::StrCat("the motion file is not JSON: it cannot be read from line ",
                                    1 + std::ranges::count(before, '\n'), ", column ",
                                    1 + before.size() - line_begin, " on"));
  } catch (const json::exception&) {
    return MotionFault("the motion file is not JSON");
  }
  return MotionParser(root, skeleton, limits).Parse();
}

nlohmann::ordered_json MotionToJson(const Skeleton& skeleton, const PoseTrack& track,
                                    const std::vector<double>& bone_scales) {
  assert(CheckJointCount(track, skeleton.num_joints()).ok());
  nlohmann::ordered_json root;
  root["schema"] = kMotionSchema;
  root["fps"] = track.fps();
  for (const Joint& joint : skeleton.joints()) root["joints"].push_back(joint.name);
  root["frames"] = nlohmann::ordered_json::array();
  for (const Pose& pose : track.poses()) {
    nlohmann::ordered_json frame;
    const Eigen::Vector3d& root_position = pose.root_position;
    frame["root_translation"] = {root_position.x(), root_position.y(), root_position.z()};
    for (const Eigen::Quaterniond& q : pose.rotations) {
      frame["rotations"].push_back({q.w(), q.x(), q.y(), q.z()});
    }
    root["frames"].push_back(std::move(frame));
  }
  for (size_t j = 0; j < bone_scales.size(); ++j) {
    root["bone_scales"][skeleton.joint(static_cast<int>(j)).name] = bone_scales[j];
  }
  if (track.clip_starts().size() > 1) root["clip_starts"] = track.clip_starts();
  return root;
}

nlohmann::ordered_json MotionToJson(const Skeleton& skeleton, const Motion& motion) {
  nlohmann::ordered_json root = MotionToJson(skeleton, motion.track, motion.bone_scales);
  for (size_t j = 0; j < motion.detail_strengths.size(); ++j) {
    root["detail_strengths"][skeleton.joint(static_cast<int>(j)).name] = motion.detail_strengths[j];
  }
  // Five digits tell a painted factor well enough, and keep the file small.
  for (const float strength : motion.vertex_strengths) {
    root["vertex_strengths"].push_back(std::round(1e5 * strength) / 1e5);
  }
  root["skeleton"] = nlohmann::ordered_json::array();
  for (const Joint& joint : skeleton.joints()) {
    const Eigen::Vector3d& rest = joint.rest_position;
    root["skeleton"].push_back({{"name", joint.name},
                                {"parent", joint.parent},
                                {"rest_position", {rest.x(), rest.y(), rest.z()}}});
  }
  return root;
}

std::string DumpMotion(const nlohmann::ordered_json& root) {
  return root.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string EncodeMotion(const Skeleton& skeleton, const PoseTrack& track,
                         const std::vector<double>& bone_scales) {
  return DumpMotion(MotionToJson(skeleton, track, bone_scales));
}

std::string EncodeMotionWithSkeleton(const Skeleton& skeleton, const Motion& motion) {
  return DumpMotion(MotionToJson(skeleton, motion));
}

absl::Status WriteMotion(const std::string& path, const Skeleton& skeleton, const PoseTrack& track,
                         const std::vector<double>& bone_scales) {
  return WriteFile(path, EncodeMotion(skeleton, track, bone_scales));
}

}  // namespace pleat
