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

// Joints in order: {"name", "parent", "position_m"}, rest pose.
nlohmann::ordered_json JointsJson(const Skeleton& skeleton);

// {"mean_percent", "rms_percent", "p95_percent", "max_percent", "mean_mm"}
nlohmann::ordered_json ErrorJson(const ErrorSummary& error);

// How the motion looks: {"num_frames", "mean_percent", "mean_mm" (of frame-to-frame steps),
// "jitter_mm", "truth_jitter_mm"}; numbers that could not be measured are null.
nlohmann::ordered_json MotionJson(const ErrorSummary& error);

// Every option by name, numbers as numbers.
nlohmann::ordered_json OptionsJson(const TrainOptions& options);
nlohmann::ordered_json OptionsJson(const CompressOptions& options);

// What the computation cost, beside what the model itself knows.
struct TrainCosts {
  std::map<std::string, double> seconds;  // per stage
  uint64_t peak_memory_bytes = 0;         // of this process
  uint64_t model_bytes = 0;
  std::string model_id;  // content id of those bytes
};

// "pleat.train/1"
nlohmann::ordered_json TrainReportJson(const CharacterModel& model, const TrainCosts& costs);

// "pleat.compress/1"
nlohmann::ordered_json CompressReportJson(const CompressionRecord& record, int num_frames,
                                          int num_vertices);

// What the learner "auto" chose by: {"num_held_out_frames", "mean_percent": {learner: number}}, or
// null when nothing was held out.
nlohmann::ordered_json ValidationJson(const LearnerValidation& validation);

// "pleat.evaluate/1"
nlohmann::ordered_json EvaluateReportJson(const EvaluateReport& report);

}  // namespace pleat
