// NumPy's archives (.npz) and arrays (.npy) with the positions of all frames (docs/formats/npz.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The names of arrays in an archive. Empty: those that Pleat writes ("positions", "faces",
// "face_sizes", "frame_rate"), and when one is read that is not there, those that other programs
// are known to use.
struct NpzKeys {
  std::string positions{}, faces{}, face_sizes{}, frame_rate{};
};

// Reads "positions=verts" and the like into `keys`. kInvalidArgument names the known roles.
absl::Status SetNpzKey(const std::string& assignment, NpzKeys* keys);

struct NpzContents {
  std::vector<Eigen::Matrix3Xf> frames;  // T matrices of 3 x V
  std::optional<Topology> topology{};    // none where the file has positions alone
  MeshAppearance appearance{};           // empty without a topology
  std::optional<FrameRate> frame_rate{};
  std::optional<double> first_frame{};
  std::string name{};              // of the sequence, UTF-8; empty when the file has none
  std::vector<InputNote> notes{};  // without the file's name
};

// Reads an archive, or a single array, which holds positions alone. kInvalidArgument names what is
// wrong with which array, and the arrays that are there; kDataLoss what is cut off;
// kResourceExhausted the limit that is exceeded. `file` is the name used in messages.
absl::StatusOr<NpzContents> DecodeNpz(std::string_view bytes, const std::string& file,
                                      const NpzKeys& keys = {}, const MeshLimits& limits = {});

struct NpzWriteOptions {
  NpzKeys keys{};
  double first_frame = 0;
  bool compressed = false;
};
std::string EncodeNpz(const MeshSequence& sequence, const NpzWriteOptions& options = {});
absl::Status WriteNpz(const std::string& path, const MeshSequence& sequence,
                      const NpzWriteOptions& options = {});
// The positions alone, float32 of shape (T, V, 3).
std::string EncodeNpy(const MeshSequence& sequence);
absl::Status WriteNpy(const std::string& path, const MeshSequence& sequence);

}  // namespace pleat
