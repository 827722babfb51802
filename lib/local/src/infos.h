// Descriptions of sequences and models.
#pragma once

#include <string>

#include "pleat/service/character_service.h"

namespace pleat {

SequenceInfo MakeSequenceInfo(const MeshSequence& sequence, const std::string& id,
                              uint64_t size_bytes);
ModelInfo MakeModelInfo(const CharacterModel& model, const std::string& id, uint64_t size_bytes);

}  // namespace pleat
