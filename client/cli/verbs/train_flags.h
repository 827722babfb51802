// TrainOptions on the command line: one flag for each option, made from the one list of options.
#pragma once

#include <map>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "pleat/character/train_options.h"

namespace pleat {

struct TrainFlags {
  std::string preset;                         // "default" or "paper"; empty means "default"
  std::map<std::string, std::string> values;  // the texts that were given, by the option's name
};

// Adds --preset and a flag for every option ("detail_axes" is --detail-axes, or --axes for short).
void AddTrainFlags(CLI::App* verb, TrainFlags* flags);

// Returns the preset with the given values in place of its own. A usage error names the option, its
// value and the range.
absl::StatusOr<TrainOptions> ResolveTrainFlags(const TrainFlags& flags);

}  // namespace pleat
