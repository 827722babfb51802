// docs/options.md says what the table of options says, word for word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <type_traits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "pleat/base/file.h"
#include "pleat/character/train_options.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// "name=value" of every option is what text, model file and report show; one that has no line has
// the value `unwritten`.
std::string ValueOf(const TrainOptions& options, const std::string& name,
                    const std::string& unwritten) {
  const std::string text = "\n" + FormatTrainOptions(options);
  const size_t line = text.find(absl::StrCat("\n", name, "="));
  if (line == std::string::npos) return unwritten;
  const size_t begin = line + name.size() + 2;
  return text.substr(begin, text.find('\n', begin) - begin);
}

// The section of one option: help, flags, default, the paper's value where it is another, choices.
template <typename T>
std::string Section(const std::string& name, [[maybe_unused]] const T& default_value) {
  const OptionText& text = TextOfOption(name);
  std::string flags = absl::StrCat("`--", absl::StrReplaceAll(name, {{"_", "-"}}), "`");
  if (text.alias != nullptr) absl::StrAppend(&flags, " or `--", text.alias, "`");
  std::string unwritten;
  if constexpr (std::is_enum_v<T>) unwritten = ChoiceName(default_value);
  if constexpr (std::is_same_v<T, int>) unwritten = absl::StrCat(default_value);
  const std::string value = ValueOf({}, name, unwritten),
                    paper = ValueOf(TrainOptions::Paper(), name, unwritten);
  std::string section = absl::StrCat("## ", name, "\n\n", flags, ", default ",
                                     value.empty() ? "none" : absl::StrCat("`", value, "`"));
  if (paper != value) absl::StrAppend(&section, ", preset paper `", paper, "`");
  std::string help = text.help;
  help[0] = static_cast<char>(std::toupper(help[0]));
  absl::StrAppend(&section, "\n\n", help);
  if constexpr (std::is_enum_v<T>) {
    absl::StrAppend(&section, ":\n\n");
    for (const NamedChoice<T>& choice : ChoicesOf<T>()) {
      absl::StrAppend(&section, "- `", choice.name, "` - ", choice.help, "\n");
    }
  } else {
    absl::StrAppend(&section, ".\n");
  }
  return section;
}

TEST(OptionsPageTest, HoldsEveryOptionAsTheTableHasIt) {
  std::string expected;
  const TrainOptions defaults;
  VisitTrainOptions(defaults, [&](const char* name, const auto& value) {
    absl::StrAppend(&expected, "\n", Section(name, value));
  });
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string page, ReadFile(InSourceFolder("docs/options.md")));
  EXPECT_EQ(page.substr(std::min(page.size(), page.find("\n## "))), expected);
}

}  // namespace
}  // namespace pleat
