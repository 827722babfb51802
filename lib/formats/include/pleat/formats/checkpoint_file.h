// Checkpoints of trainings (docs/formats/checkpoint.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/character/training_checkpoint.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

struct CheckpointFile {
  std::string job_id;  // whose it is, 1 to 64 bytes
  // All that decides the result of the training, as text: a checkpoint of other inputs is of no
  // use.
  std::string inputs;
  TrainingCheckpoint checkpoint;  // that has at least a rig
};

// The longest text of inputs that is read, in bytes.
inline constexpr size_t kMaxCheckpointInputsBytes = size_t{1} << 20;

// Every number is written as it is in memory: a training that goes on from what DecodeCheckpoint
// returns computes the same bits. Equal content gives equal bytes. `file` must have a rig.
std::string EncodeCheckpoint(const CheckpointFile& file);

// kInvalidArgument for another kind of file, another version, or values that do not fit together;
// kDataLoss for damage; kResourceExhausted for what exceeds the limits.
absl::StatusOr<CheckpointFile> DecodeCheckpoint(std::string_view bytes,
                                                const MeshLimits& limits = {});

}  // namespace pleat
