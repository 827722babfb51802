#include "cli/io/joint_truth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxBytes = uint64_t{64} << 20;
constexpr int kMaxFrame = 100'000;

absl::Status Fault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("joint truth: ", what));
}

absl::StatusOr<Eigen::Vector3d> ReadPosition(const json& joint, const std::string& name) {
  const auto position = joint.find("position_m");
  if (position == joint.end() || !position->is_array() || position->size() != 3) {
    return Fault(absl::StrCat("joint '", name, "' needs a position_m of three numbers"));
  }
  Eigen::Vector3d result;
  for (int k = 0; k < 3; ++k) {
    result[k] = (*position)[k].is_number() ? (*position)[k].get<double>() : std::nan("");
    if (!std::isfinite(result[k])) {
      return Fault(absl::StrCat("position_m of joint '", name, "' is not finite"));
    }
  }
  return result;
}

}  // namespace

absl::StatusOr<JointTruth> DecodeJointTruth(std::string_view text) {
  const json root = json::parse(text, nullptr, false);
  if (!root.is_object()) return Fault("the file is not a JSON object");
  const auto joints = root.find("joints");
  if (joints == root.end() || !joints->is_array() || joints->empty()) {
    return Fault("the list 'joints' is missing or empty");
  }
  JointTruth truth;
  truth.positions.resize(3, static_cast<Eigen::Index>(joints->size()));
  std::set<std::string> seen;
  for (const json& joint : *joints) {
    const auto name = joint.is_object() ? joint.find("name") : joint.end();
    if (!joint.is_object() || name == joint.end() || !name->is_string()) {
      return Fault(absl::StrCat("joint ", truth.names.size(), " has no name"));
    }
    if (!seen.insert(name->get<std::string>()).second) {
      return Fault(absl::StrCat("joint '", name->get<std::string>(), "' is listed twice"));
    }
    PLEAT_ASSIGN_OR_RETURN(truth.positions.col(static_cast<Eigen::Index>(truth.names.size())),
                           ReadPosition(joint, name->get<std::string>()));
    truth.names.push_back(name->get<std::string>());
  }
  if (const auto frame = root.find("frame"); frame != root.end()) {
    if (!frame->is_number_integer() || *frame < 0 || *frame > kMaxFrame) {
      return Fault("'frame' must be a frame number");
    }
    truth.frame = frame->get<int>();
  }
  return truth;
}

absl::StatusOr<JointTruth> ReadJointTruth(const std::string& path) {
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  absl::StatusOr<JointTruth> truth = DecodeJointTruth(text);
  if (!truth.ok()) {
    return absl::Status(truth.status().code(), absl::StrCat(path, ": ", truth.status().message()));
  }
  return truth;
}

std::string FindJointTruth(const std::string& input) {
  const std::filesystem::path path(input);
  std::error_code error;
  for (const std::filesystem::path& candidate :
       {path.parent_path() / (path.stem().string() + "_truth.json"),
        path.parent_path() / "truth.json"}) {
    if (std::filesystem::is_regular_file(candidate, error)) return candidate.string();
  }
  return "";
}

absl::StatusOr<JointErrors> CompareJoints(const JointTruth& truth, const Skeleton& skeleton,
                                          const Eigen::Matrix3Xd& joints) {
  JointErrors errors;
  for (size_t i = 0; i < truth.names.size(); ++i) {
    const int j = skeleton.FindJoint(truth.names[i]);
    if (j < 0) continue;
    const double error_m =
        (joints.col(j) - truth.positions.col(static_cast<Eigen::Index>(i))).norm();
    errors.names.push_back(truth.names[i]);
    errors.errors_m.push_back(error_m);
    errors.mean_m += error_m;
    errors.max_m = std::max(errors.max_m, error_m);
  }
  if (errors.names.empty()) {
    return Fault("none of its joints has the name of a joint of the rig");
  }
  errors.mean_m /= static_cast<double>(errors.names.size());
  return errors;
}

}  // namespace pleat
