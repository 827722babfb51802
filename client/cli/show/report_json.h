// The JSON reports of `train`, `evaluate` and `compress` (client/README.md).
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pleat/character/character_model.h"
#include "pleat/character/evaluate.h"
#include "pleat/character/train_options.h"
#include "pleat/mesh/error_metrics.h"
#include "pleat/service/character_service.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Returns the joints in order as {"name", "parent", "position_m"}, in the rest pose.
nlohmann::ordered_json JointsJson(const Skeleton& skeleton);

// Returns {"mean_percent", "rms_percent", "p95_percent", "max_percent", "mean_mm"}.
nlohmann::ordered_json ErrorJson(const ErrorSummary& error);

// Returns how the motion looks: {"num_frames", "mean_percent", "mean_mm", "jitter_mm",
// "truth_jitter_mm"}, where the means are those of the steps from frame to frame. Numbers that
// could not be measured are null.
nlohmann::ordered_json MotionJson(const ErrorSummary& error);

// Return every option by its name, with numbers as numbers.
nlohmann::ordered_json OptionsJson(const TrainOptions& options);
nlohmann::ordered_json OptionsJson(const CompressOptions& options);

// What the computation cost; the model itself does not know it.
struct TrainCosts {
  std::map<std::string, double> seconds;  // by the name of the stage
  uint64_t peak_memory_bytes = 0;         // the largest resident size of this process
  uint64_t model_bytes = 0;
  std::string model_id;  // the content id of these bytes
};

// Returns the report in the schema "pleat.train/1".
nlohmann::ordered_json TrainReportJson(const CharacterModel& model, const TrainCosts& costs);

// Returns the report in the schema "pleat.compress/1".
nlohmann::ordered_json CompressReportJson(const CompressionRecord& record, int num_frames,
                                          int num_vertices);

// Returns what the learner "auto" chose by: {"num_held_out_frames", "mean_percent": {learner:
// number}}, or null when nothing was held out.
nlohmann::ordered_json ValidationJson(const LearnerValidation& validation);

// Returns the report in the schema "pleat.evaluate/1".
nlohmann::ordered_json EvaluateReportJson(const EvaluateReport& report);

}  // namespace pleat
