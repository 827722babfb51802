// Make the descriptions of sequences and models that the services return and the catalog keeps.
#pragma once

#include <string>

#include "pleat/sequence_codec/sequence_decoder.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

SequenceInfo MakeSequenceInfo(const MeshSequence& sequence, const std::string& id,
                              uint64_t size_bytes);
ModelInfo MakeModelInfo(const CharacterModel& model, const std::string& id, uint64_t size_bytes);

// Without a record: the file does not hold how it was made.
CompressedSequenceInfo MakeCompressedSequenceInfo(const SequenceDecoder& decoder,
                                                  const std::string& id, uint64_t size_bytes);

}  // namespace pleat
