// Everything Pleat offers, without saying where it runs.
#pragma once

#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/pose_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

// Owns the five services that belong together; they live as long as it does. Implemented in this
// process (lib/local) and over the network (client/remote). One contract test suite runs on both.
class CharacterService {
 public:
  virtual ~CharacterService() = default;
  virtual SequenceService& sequences() = 0;
  virtual JobService& jobs() = 0;
  virtual ModelService& models() = 0;
  virtual PoseService& poses() = 0;
  virtual CompressedSequenceService& compressed_sequences() = 0;
};

}  // namespace pleat
