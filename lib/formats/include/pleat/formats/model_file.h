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

// Reads a model from hostile bytes. kInvalidArgument says that they are no model file or of another
// version, or which parts do not fit together; kDataLoss that they are cut off or corrupt;
// kResourceExhausted names the limit that they exceed.
absl::StatusOr<std::shared_ptr<const CharacterModel>> DecodeModel(std::string_view bytes,
                                                                  const MeshLimits& limits = {});

// Does the same for a file; the errors name it.
absl::StatusOr<std::shared_ptr<const CharacterModel>> ReadModelFile(const std::string& path,
                                                                    const MeshLimits& limits = {});

// Returns the id of a model file: the SHA-256 of its bytes as 64 lower-case hexadecimal digits.
std::string ModelId(std::string_view bytes);

}  // namespace pleat
