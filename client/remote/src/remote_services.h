// The remote services that offer nothing beyond their interface.
#pragma once

#include <memory>

#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"
#include "remote_state.h"

namespace pleat {

// `state` must outlive the services.
std::unique_ptr<SequenceService> MakeRemoteSequences(RemoteState* state);
std::unique_ptr<JobService> MakeRemoteJobs(RemoteState* state);
std::unique_ptr<ModelService> MakeRemoteModels(RemoteState* state);
std::unique_ptr<CompressedSequenceService> MakeRemoteCompressedSequences(RemoteState* state);

}  // namespace pleat
