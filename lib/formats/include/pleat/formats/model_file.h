// The character model as bytes (docs/formats/model_file.md).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

struct ModelFileLimits {
  MeshFileLimits mesh{};
  // What a small file could unfold to: the upsampled detail basis and the whiteners.
  uint64_t max_unfolded_bytes = uint64_t{4} << 30;
};

// The same model always gives the same bytes.
std::string EncodeModel(const CharacterModel& model);

// kInvalidArgument: not a model file, another version, or parts that do not fit together.
// kDataLoss: cut off or corrupt. kResourceExhausted: above a limit.
absl::StatusOr<std::shared_ptr<const CharacterModel>> DecodeModel(
    std::string_view bytes, const ModelFileLimits& limits = {});

absl::StatusOr<std::shared_ptr<const CharacterModel>> ReadModelFile(
    const std::string& path, const ModelFileLimits& limits = {});
absl::Status WriteModelFile(const std::string& path, const CharacterModel& model);

// Id of a model file: SHA-256 of its bytes, 64 lower-case hexadecimal digits.
std::string ModelId(std::string_view bytes);

}  // namespace pleat
