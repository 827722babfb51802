// Known joint positions of a sequence, to score a rig with.
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

// A JSON object {"joints": [{"name", "position_m": [x, y, z]}, ...], "frame": 0}; other members are
// ignored, so the truth.json of a generated performer is one. kInvalidArgument names what is wrong.
absl::StatusOr<JointTruth> DecodeJointTruth(std::string_view text);
absl::StatusOr<JointTruth> ReadJointTruth(const std::string& path);

// The truth that lies beside `input`: <stem>_truth.json or truth.json in its folder. Empty when
// there is none.
std::string FindJointTruth(const std::string& input);

struct JointErrors {
  std::vector<std::string> names;  // of the joints that truth and skeleton share
  std::vector<double> errors_m;
  double mean_m = 0, max_m = 0;
};

// Distances between equally named joints; joints: 3 x J, in the truth's frame. kInvalidArgument
// when the two share no name.
absl::StatusOr<JointErrors> CompareJoints(const JointTruth& truth, const Skeleton& skeleton,
                                          const Eigen::Matrix3Xd& joints);

}  // namespace pleat
