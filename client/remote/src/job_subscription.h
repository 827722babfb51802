// A job of a server as one observer follows it.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/job_service.h"
#include "remote_state.h"

namespace pleat {

// Waits for the first state of the job. Watches again when the connection breaks.
absl::StatusOr<std::unique_ptr<JobSubscription>> OpenRemoteSubscription(
    const RemoteState* state, const std::string& id, std::function<void()> listener);

}  // namespace pleat
