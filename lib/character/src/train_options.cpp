#include "pleat/character/train_options.h"

#include <cstdio>
#include <limits>
#include <type_traits>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "pleat/base/status.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {
namespace {

template <typename T>
absl::Status CheckRange(absl::string_view name, T value, T low, T high) {
  if (value >= low && value <= high) return absl::OkStatus();  // a NaN fails both
  return absl::InvalidArgumentError(
      absl::StrCat("option ", name, ": ", value, " is outside ", low, " to ", high));
}

// Returns the shortest decimal text that reads back as the same value.
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
  } else if constexpr (std::is_enum_v<T>) {
    return ChoiceName(value);
  } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
    return FormatPlacedJoints(value);
  } else {
    return absl::StrCat(value);
  }
}

template <typename T>
absl::Status ParseValue(absl::string_view option, absl::string_view text, T* value) {
  if constexpr (std::is_enum_v<T>) {
    PLEAT_ASSIGN_OR_RETURN(*value, ParseChoice<T>(option, text));
    return absl::OkStatus();
  } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
    PLEAT_ASSIGN_OR_RETURN(*value,
                           WithContext(absl::StrCat("option ", option), ParsePlacedJoints(text)));
    return absl::OkStatus();
  } else {
    bool parsed;
    if constexpr (std::is_same_v<T, double>) {
      parsed = absl::SimpleAtod(text, value);
    } else {
      parsed = absl::SimpleAtoi(text, value);
    }
    if (parsed) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat("a value that does not parse: '", option, "=", text, "'"));
  }
}

}  // namespace

TrainOptions TrainOptions::Paper() {
  TrainOptions paper;
  paper.learner = LearnerChoice::kSgplvm;
  paper.fit = PoseFitMethod::kWalk;
  paper.refine = RigRefinement::kNone;
  paper.influences = kStandardInfluences;
  paper.detail_axes = DetailAxes::kWorld;
  paper.history_form = HistoryForm::kPoses;
  paper.resolution_percent = 5;
  paper.upsampling = Upsampling::kRbf;
  paper.bend_stiffness = 1e-6;
  paper.latent_dimensions = 4;
  return paper;
}

const std::vector<std::string>& LearnerNames() {
  static const auto& names = *[] {
    auto* learners = new std::vector<std::string>;
    for (const NamedChoice<LearnerChoice>& choice : ChoicesOf<LearnerChoice>()) {
      if (choice.value != LearnerChoice::kAuto) learners->push_back(choice.name);
    }
    return learners;
  }();
  return names;
}

absl::Status ValidateTrainOptions(const TrainOptions& options) {
  absl::Status choices;
  VisitTrainOptions(options, [&choices](const char* name, const auto& value) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>) {
      if (ChoiceNameOrNull(value) == nullptr) {
        choices = absl::InvalidArgumentError(
            absl::StrCat("option ", name, ": ", static_cast<int>(value), " is no choice"));
      }
    }
  });
  PLEAT_RETURN_IF_ERROR(choices);
  PLEAT_RETURN_IF_ERROR(CheckRange("bend_stiffness", options.bend_stiffness, 0.0, 1.0));
  PLEAT_RETURN_IF_ERROR(CheckRange("smoothness", options.smoothness, 0.0, 1.0));
  PLEAT_RETURN_IF_ERROR(CheckRange("influences", options.influences, 1, kMaxInfluences));
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
  PLEAT_RETURN_IF_ERROR(CheckRange("max_components", options.max_components, 1, 1024));
  return WithContext("option placed_joints", CheckPlacedJoints(options.placed_joints));
}

std::string FormatTrainOptions(const TrainOptions& options) {
  std::string text;
  VisitTrainOptions(options, [&](const char* name, const auto& value) {
    using T = std::decay_t<decltype(value)>;
    // These are younger than the first models.
    if constexpr (std::is_same_v<T, int>) {
      if (&value == &options.influences && value == TrainOptions().influences) return;
    } else if constexpr (std::is_same_v<T, JumpPolicy>) {
      if (value == TrainOptions().jumps) return;
    } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
      if (value.empty()) return;
    }
    absl::StrAppend(&text, name, "=", FormatValue(value), "\n");
  });
  return text;
}

absl::StatusOr<TrainOptions> ParseTrainOptions(absl::string_view text) {
  TrainOptions options;
  for (absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    const std::pair<absl::string_view, absl::string_view> pair =
        absl::StrSplit(line, absl::MaxSplits('=', 1));
    absl::Status status =
        absl::InvalidArgumentError(absl::StrCat("an unknown option: '", line, "'"));
    VisitTrainOptions(options, [&](const char* name, auto& value) {
      if (pair.first == name) status = ParseValue(name, pair.second, &value);
    });
    PLEAT_RETURN_IF_ERROR(status);
  }
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  return options;
}

}  // namespace pleat
