// Follows a job of a server.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/job_service.h"
#include "remote_state.h"

namespace pleat {

// Opens a watch, waits for the first state of the job and returns, or says why there is none. It
// watches again when the connection breaks. `state` must outlive the subscription.
absl::StatusOr<std::unique_ptr<JobSubscription>> OpenRemoteSubscription(
    const RemoteState* state, const std::string& id, std::function<void()> listener);

}  // namespace pleat
