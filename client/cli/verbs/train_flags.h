// TrainOptions on the command line: one flag per option, from the one list of options.
#pragma once

#include <map>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "pleat/character/train_options.h"

namespace pleat {

struct TrainFlags {
  std::string preset;                         // "default" or "paper"; empty = not given: default
  std::map<std::string, std::string> values;  // option name -> text, only those that were given
};

// Adds --preset and a flag for every option ("detail_axes" is --detail-axes, or --axes for short).
void AddTrainFlags(CLI::App* verb, TrainFlags* flags);

// The preset with the given values over it; a usage error names option, value and range.
absl::StatusOr<TrainOptions> ResolveTrainFlags(const TrainFlags& flags);

}  // namespace pleat
