// The character model as bytes (docs/formats/model_file.md).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

// The same model always gives the same bytes.
std::string EncodeModel(const CharacterModel& model);

// kInvalidArgument: not a model file, another version, or parts that do not fit together.
// kDataLoss: cut off or corrupt. kResourceExhausted: above a limit.
absl::StatusOr<std::shared_ptr<const CharacterModel>> DecodeModel(std::string_view bytes,
                                                                  const MeshLimits& limits = {});

absl::StatusOr<std::shared_ptr<const CharacterModel>> ReadModelFile(const std::string& path,
                                                                    const MeshLimits& limits = {});

// Id of a model file: SHA-256 of its bytes, 64 lower-case hexadecimal digits.
std::string ModelId(std::string_view bytes);

}  // namespace pleat
