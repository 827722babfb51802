// The known joint positions of a sequence, with which a rig is scored.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Where the named joints are in one frame of a sequence.
struct JointTruth {
  int frame = 0;
  std::vector<std::string> names;
  Eigen::Matrix3Xd positions;  // 3 x N, meters
};

// Reads a JSON object {"joints": [{"name", "position_m": [x, y, z]}, ...], "frame": 0}. Other
// members are ignored, so the truth.json of a generated performer will do. kInvalidArgument says
// what is wrong.
absl::StatusOr<JointTruth> DecodeJointTruth(std::string_view text);
absl::StatusOr<JointTruth> ReadJointTruth(const std::string& path);

// Returns the path of the truth that lies beside `input`: <stem>_truth.json or truth.json in its
// folder. Returns an empty path when there is none.
std::string FindJointTruth(const std::string& input);

struct JointErrors {
  std::vector<std::string> names;  // the joints that truth and skeleton have in common
  std::vector<double> errors_m;
  double mean_m = 0, max_m = 0;
};

// Measures the distances between joints of the same name. joints: 3 x J, meters, those of
// `skeleton` in the truth's frame. kInvalidArgument when the two have no name in common.
absl::StatusOr<JointErrors> CompareJoints(const JointTruth& truth, const Skeleton& skeleton,
                                          const Eigen::Matrix3Xd& joints);

}  // namespace pleat
