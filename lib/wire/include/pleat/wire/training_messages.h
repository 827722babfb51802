// Training options and records on the wire.
#pragma once

#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/character/train_options.h"
#include "pleat/v1/training.pb.h"

namespace pleat {

v1::TrainOptions ToProto(const TrainOptions& options);  // sets every field
// Fields that are not set keep their defaults. kInvalidArgument names an option that is out of
// range.
absl::StatusOr<TrainOptions> FromProto(const v1::TrainOptions& message);

v1::TrainingRecord ToProto(const TrainingRecord& record);
TrainingRecord FromProto(const v1::TrainingRecord& message);

}  // namespace pleat
