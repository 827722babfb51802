// PointCache2 files (.pc2): the positions of all frames, without connectivity.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// The file is little-endian: "POINTCACHE2\0", int32 version 1, int32 V, float32 start, float32
// rate, int32 T, then T x V x 3 float32.
struct PointCache {
  float start_frame = 0;
  float sample_rate = 1;                 // frames of the host's timeline per sample, not fps
  std::vector<Eigen::Matrix3Xf> frames;  // T matrices of 3 x V
};

// kInvalidArgument says what is wrong with the header, kDataLoss that the length disagrees with it,
// kResourceExhausted which limit is exceeded. `file` is the name used in messages.
absl::StatusOr<PointCache> DecodePointCache(std::string_view bytes, const std::string& file,
                                            const MeshLimits& limits = {});
absl::StatusOr<PointCache> ReadPointCache(const std::string& path, const MeshLimits& limits = {});

// The frames must not be empty and must have the same number of columns (asserted).
std::string EncodePointCache(const PointCache& cache);
absl::Status WritePointCache(const std::string& path, const PointCache& cache);

}  // namespace pleat
