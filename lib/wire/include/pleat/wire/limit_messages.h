// Refusals for a limit as google.rpc.QuotaFailure and RetryInfo, which gRPC carries beside a
// status.
#pragma once

#include <google/protobuf/any.pb.h>

#include <string>

#include "absl/status/status.h"

namespace pleat {

using DetailList = google::protobuf::RepeatedPtrField<google::protobuf::Any>;

// Adds the details of a LimitRefusal; nothing for other errors.
void AddLimitDetails(const absl::Status& status, DetailList* details);
// A serialized google.rpc.Status with the details of a LimitRefusal; empty for other errors.
std::string LimitDetailsOf(const absl::Status& status);

// `status` as a LimitRefusal when the details that came with it say that it is one, and unchanged
// otherwise. Foreign and malformed details are left alone.
absl::Status WithLimitDetails(const absl::Status& status, const std::string& details);
absl::Status WithLimitDetails(const absl::Status& status, const DetailList& details);

}  // namespace pleat
