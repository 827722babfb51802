// The one table of what training options are called: the names of their choices, and what the help
// says about each. Text, model files, the wire, flags and docs/options.md take the names from here.
#pragma once

#include <span>
#include <string>
#include <type_traits>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "pleat/fitting/details.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/skeleton/pose_features.h"

namespace pleat {

// A learner as it is asked for. The enum `Learner` of a trained model is another one: it does not
// know "auto", and both forms of the regional learner, and of the shared GPLVM, are one value
// there.
enum class LearnerChoice {
  kAuto,
  kRegional,
  kRegionalFast,
  kGp,
  kSgplvm,
  kBackConstrained,
  kRidge
};

// Which part of the rig is refined on the training frames.
enum class RigRefinement { kNone, kJoints, kFull };

// How the details of control vertices are written: as they are, or as differences from the mean of
// their neighbors.
enum class DetailCoordinates { kOffsets, kDifferential };

// How the details of the control vertices spread to all vertices.
enum class Upsampling { kRefined, kRbf };

// What happens to clips whose frames jump (pleat/mesh/frame_jumps.h).
enum class JumpPolicy { kRefuse, kAllow };

template <typename Choice>
struct NamedChoice {
  Choice value;
  const char* name;  // never changes, since text, model files, the wire and flags contain it
  const char* help;  // a phrase
};

// Returns every value of an option's enum, in the order in which they are listed.
template <typename Choice>
std::span<const NamedChoice<Choice>> ChoicesOf();

template <>
std::span<const NamedChoice<LearnerChoice>> ChoicesOf();
template <>
std::span<const NamedChoice<PoseFitMethod>> ChoicesOf();
template <>
std::span<const NamedChoice<RigRefinement>> ChoicesOf();
template <>
std::span<const NamedChoice<DetailBase>> ChoicesOf();
template <>
std::span<const NamedChoice<DetailAxes>> ChoicesOf();
template <>
std::span<const NamedChoice<DetailCoordinates>> ChoicesOf();
template <>
std::span<const NamedChoice<RotationRepresentation>> ChoicesOf();
template <>
std::span<const NamedChoice<HistoryForm>> ChoicesOf();
template <>
std::span<const NamedChoice<Upsampling>> ChoicesOf();
template <>
std::span<const NamedChoice<JumpPolicy>> ChoicesOf();

// Returns the name of a value, or null for a number that is no value of the enum.
template <typename Choice>
const char* ChoiceNameOrNull(Choice value) {
  for (const NamedChoice<Choice>& choice : ChoicesOf<Choice>()) {
    if (choice.value == value) return choice.name;
  }
  return nullptr;
}

// Returns the name that the table gives to a value of the enum.
template <typename Choice>
std::string ChoiceName(Choice value) {
  const char* name = ChoiceNameOrNull(value);
  return name ? name : "unknown";
}

// Returns the value with this name. kInvalidArgument names the option and lists the valid names.
template <typename Choice>
absl::StatusOr<Choice> ParseChoice(absl::string_view option, absl::string_view name) {
  std::string names;
  for (const NamedChoice<Choice>& choice : ChoicesOf<Choice>()) {
    if (choice.name == name) return choice.value;
    absl::StrAppend(&names, names.empty() ? "" : ", ", choice.name);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("option ", option, ": '", name, "' is unknown; choose one of ", names));
}

struct OptionText {
  const char* name;   // the name of the member of TrainOptions
  const char* alias;  // a second, shorter flag, or null
  const char* help;   // a phrase; for an option with choices, it says what is chosen
};
// The texts of all options, in the order of VisitTrainOptions.
std::span<const OptionText> OptionTexts();
// Returns the texts of the option `name`, which must exist (asserted).
const OptionText& TextOfOption(absl::string_view name);

}  // namespace pleat
