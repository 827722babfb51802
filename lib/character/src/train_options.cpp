#include "pleat/character/train_options.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <type_traits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckChoice(absl::string_view name, const std::string& value,
                         const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "option ", name, ": '", value, "' is unknown; choose one of ", absl::StrJoin(choices, ", ")));
}

template <typename T>
absl::Status CheckRange(absl::string_view name, T value, T low, T high) {
  if (value >= low && value <= high) return absl::OkStatus();  // a NaN fails both
  return absl::InvalidArgumentError(
      absl::StrCat("option ", name, ": ", value, " is outside ", low, " to ", high));
}

// The shortest decimal text that reads back as the same value.
template <typename T>
std::string FormatValue(const T& value) {
  if constexpr (std::is_same_v<T, double>) {
    for (int digits = 6; digits < 17; ++digits) {
      char text[40];
      std::snprintf(text, sizeof(text), "%.*g", digits, value);
      double back;
      if (absl::SimpleAtod(text, &back) && back == value) return text;
    }
    char text[40];
    std::snprintf(text, sizeof(text), "%.17g", value);
    return text;
  } else {
    return absl::StrCat(value);
  }
}

template <typename T>
bool ParseValue(absl::string_view text, T* value) {
  if constexpr (std::is_same_v<T, std::string>) {
    *value = std::string(text);
    return true;
  } else if constexpr (std::is_same_v<T, double>) {
    return absl::SimpleAtod(text, value);
  } else {
    return absl::SimpleAtoi(text, value);
  }
}

}  // namespace

TrainOptions TrainOptions::Paper() {
  TrainOptions paper;
  paper.learner = "sgplvm";
  paper.fit = "walk";
  paper.refine = "none";
  paper.detail_axes = "world";
  paper.history_form = "poses";
  paper.resolution_percent = 5;
  paper.upsampling = "rbf";
  paper.bend_stiffness = 1e-6;
  paper.latent_dimensions = 4;
  return paper;
}

const std::vector<std::string>& LearnerNames() {
  static const auto& names =
      *new std::vector<std::string>{"regional", "gp", "sgplvm", "back-constrained", "ridge"};
  return names;
}

absl::Status ValidateTrainOptions(const TrainOptions& options) {
  std::vector<std::string> learners = LearnerNames();
  learners.insert(learners.begin(), "auto");
  PLEAT_RETURN_IF_ERROR(CheckChoice("learner", options.learner, learners));
  PLEAT_RETURN_IF_ERROR(CheckChoice("fit", options.fit, {"all-joints", "walk"}));
  PLEAT_RETURN_IF_ERROR(CheckChoice("refine", options.refine, {"none", "joints", "full"}));
  PLEAT_RETURN_IF_ERROR(
      CheckChoice("detail_axes", options.detail_axes, {"local", "root", "world"}));
  PLEAT_RETURN_IF_ERROR(CheckChoice("deformation", options.deformation, {"fine", "full"}));
  PLEAT_RETURN_IF_ERROR(
      CheckChoice("detail_coordinates", options.detail_coordinates, {"offsets", "differential"}));
  PLEAT_RETURN_IF_ERROR(CheckChoice("upsampling", options.upsampling, {"refined", "rbf"}));
  PLEAT_RETURN_IF_ERROR(CheckRange("bend_stiffness", options.bend_stiffness, 0.0, 1.0));
  PLEAT_RETURN_IF_ERROR(CheckRange("smoothness", options.smoothness, 0.0, 1.0));
  PLEAT_RETURN_IF_ERROR(
      CheckChoice("rotations", options.rotations, {"expmap", "euler", "quaternion"}));
  PLEAT_RETURN_IF_ERROR(
      CheckChoice("history_form", options.history_form, {"differences", "poses"}));
  PLEAT_RETURN_IF_ERROR(CheckRange("history", options.history, 1, 8));
  PLEAT_RETURN_IF_ERROR(CheckRange("resolution_percent", options.resolution_percent, 1.0, 100.0));
  PLEAT_RETURN_IF_ERROR(
      CheckRange("rest_frame", options.rest_frame, -1, std::numeric_limits<int>::max()));
  if (options.yaw_degrees != -1) {
    PLEAT_RETURN_IF_ERROR(CheckRange("yaw_degrees", options.yaw_degrees, 0.0, 360.0));
  }
  PLEAT_RETURN_IF_ERROR(CheckRange("latent_dimensions", options.latent_dimensions, 1, 32));
  PLEAT_RETURN_IF_ERROR(CheckRange("iterations", options.iterations, 1, 10000));
  PLEAT_RETURN_IF_ERROR(CheckRange("dynamics_weight", options.dynamics_weight, 0.0, 1e6));
  PLEAT_RETURN_IF_ERROR(CheckRange("detail_energy", options.detail_energy, 0.0, 1.0));
  return CheckRange("max_components", options.max_components, 1, 1024);
}

std::string FormatTrainOptions(const TrainOptions& options) {
  std::string text;
  VisitTrainOptions(options, [&text](const char* name, const auto& value) {
    absl::StrAppend(&text, name, "=", FormatValue(value), "\n");
  });
  return text;
}

absl::StatusOr<TrainOptions> ParseTrainOptions(absl::string_view text) {
  TrainOptions options;
  for (absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    const std::pair<absl::string_view, absl::string_view> pair =
        absl::StrSplit(line, absl::MaxSplits('=', 1));
    bool known = false, parsed = false;
    VisitTrainOptions(options, [&](const char* name, auto& value) {
      if (pair.first != name) return;
      known = true;
      parsed = ParseValue(pair.second, &value);
    });
    if (!known || !parsed) {
      return absl::InvalidArgumentError(absl::StrCat(
          known ? "a value that does not parse" : "an unknown option", ": '", line, "'"));
    }
  }
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  return options;
}

}  // namespace pleat
