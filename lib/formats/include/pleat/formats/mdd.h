// MDD files (.mdd): the positions of all frames with their times, without connectivity
// (docs/formats/mdd.md).
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

struct MddCache {
  std::vector<float> times_s;            // T seconds on the host's timeline
  std::vector<Eigen::Matrix3Xf> frames;  // T matrices of 3 x V
};

// kInvalidArgument says what is wrong with the header, kDataLoss that the length disagrees with it,
// kResourceExhausted which limit is exceeded. `file` is the name used in messages. Times are taken
// as they are.
absl::StatusOr<MddCache> DecodeMdd(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits = {});
absl::StatusOr<MddCache> ReadMdd(const std::string& path, const MeshLimits& limits = {});

// The frames must not be empty and must have the same number of columns, and each must have a time
// (asserted).
std::string EncodeMdd(const MddCache& cache);
absl::Status WriteMdd(const std::string& path, const MddCache& cache);

}  // namespace pleat
