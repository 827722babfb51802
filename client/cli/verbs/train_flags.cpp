#include "cli/verbs/train_flags.h"

#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "cli/exit_code.h"

namespace pleat {
namespace {

std::string FlagNames(const std::string& option) {
  std::string names = absl::StrCat("--", absl::StrReplaceAll(option, {{"_", "-"}}));
  const char* alias = TextOfOption(option).alias;
  if (alias != nullptr) absl::StrAppend(&names, ",--", alias);
  return names;
}

// Returns what the option is, its choices and what they mean, and its default.
template <typename T>
std::string HelpOf(const char* option, const T& default_value) {
  std::string help = TextOfOption(option).help;
  if constexpr (std::is_enum_v<T>) {
    const char* separator = ": ";
    for (const NamedChoice<T>& choice : ChoicesOf<T>()) {
      absl::StrAppend(&help, std::exchange(separator, ", "), choice.name, " (", choice.help, ")");
    }
    absl::StrAppend(&help, " [", ChoiceName(default_value), "]");
  } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
    absl::StrAppend(&help, " [none]");
  } else {
    absl::StrAppend(&help, " [", default_value, "]");
  }
  return help;
}

}  // namespace

void AddTrainFlags(CLI::App* verb, TrainFlags* flags) {
  const std::string group = "Training options";
  verb->add_option("--preset", flags->preset,
                   "starting values: default, or paper (the published settings)")
      ->check(CLI::IsMember({"default", "paper"}))
      ->group(group);
  const TrainOptions defaults;
  VisitTrainOptions(defaults, [&](const char* name, const auto& value) {
    const auto take = [flags, option = std::string(name)](const std::string& given) {
      flags->values[option] = given;
    };
    CLI::Option* option = nullptr;
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::vector<PlacedJoint>>) {
      option = verb->add_option_function<std::vector<std::string>>(
          FlagNames(name),
          [take](const std::vector<std::string>& texts) { take(absl::StrJoin(texts, " ")); },
          HelpOf(name, value));
    } else {
      option = verb->add_option_function<std::string>(FlagNames(name), take, HelpOf(name, value));
    }
    option->type_name("")->group(group);
  });
  verb->add_flag_callback(
          "--allow-jumps", [flags] { flags->values["jumps"] = ChoiceName(JumpPolicy::kAllow); },
          "the same as --jumps allow")
      ->group(group);
}

absl::StatusOr<TrainOptions> ResolveTrainFlags(const TrainFlags& flags) {
  std::string text =
      FormatTrainOptions(flags.preset == "paper" ? TrainOptions::Paper() : TrainOptions());
  for (const auto& [name, value] : flags.values) {
    if (value.find('\n') != std::string::npos) {
      return UsageError(absl::StrCat("the value of ", FlagNames(name), " has a line break"));
    }
    absl::StrAppend(&text, name, "=", value, "\n");
  }
  absl::StatusOr<TrainOptions> options = ParseTrainOptions(text);
  if (!options.ok()) return UsageError(std::string(options.status().message()));
  return options;
}

}  // namespace pleat
