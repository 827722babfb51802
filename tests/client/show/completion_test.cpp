#include "cli/show/completion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "absl/strings/ascii.h"
#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::Not;

class CompletionTest : public testing::Test {
 protected:
  CompletionTest() {
    EXPECT_THAT(WriteFile(script_, RunPleat({"completion", "bash"}).out), IsOk());
  }
  // What bash offers after these words, the last of which is being typed.
  std::string Offers(const std::string& words) const {
    const std::string command = "bash -c '. " + script_ + "; COMP_WORDS=(" + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _pleat; "
                                "echo \"${COMPREPLY[@]}\"' 2>&1";
    std::string out;
    FILE* pipe = popen(command.c_str(), "r");
    for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) out.push_back(static_cast<char>(c));
    EXPECT_EQ(pclose(pipe), 0) << out;
    return std::string(absl::StripAsciiWhitespace(out));
  }

  const TemporaryFolder folder_;
  const std::string script_ = folder_.File("pleat.bash");
};

TEST_F(CompletionTest, BashOffersVerbsThenFlagsThenFiles) {
  EXPECT_EQ(Offers("pleat tra"), "train");
  EXPECT_THAT(Offers("pleat \"\""), HasSubstr("inspect"));
  EXPECT_THAT(Offers("pleat train --le"), HasSubstr("--learner"));
  EXPECT_THAT(Offers("pleat train a.pc2 --ou"), HasSubstr("--output"));
  EXPECT_EQ(Offers("pleat train a"), "");  // a file
  EXPECT_EQ(Offers("pleat motion ed"), "edit");
  EXPECT_THAT(Offers("pleat motion edit --off"), HasSubstr("--offset"));
}

TEST_F(CompletionTest, OtherShellsHaveTheirOwn) {
  EXPECT_THAT(RunPleat({"completion", "zsh"}).out, testing::StartsWith("#compdef pleat"));
  const std::string fish = RunPleat({"completion", "fish"}).out;
  EXPECT_THAT(fish, HasSubstr("complete -c pleat -n '__fish_seen_subcommand_from train"));
  EXPECT_THAT(fish, HasSubstr(" -s o -l output -r "));
  EXPECT_EQ(RunPleat({"completion", "tcsh"}).code, ExitCode::kUsage);
}

TEST(FishCompletionTest, QuotesAreEscaped) {
  const Command program{.path = {},
                        .description = {},
                        .flags = {{.names = {"--x"}, .description = "it's a \\ line\nand more"}},
                        .verbs = {}};
  EXPECT_THAT(FishCompletion(program), HasSubstr("'it\\'s a \\\\ line and more'"));
  EXPECT_THAT(BashCompletion(program), Not(HasSubstr("it's")));
}

}  // namespace
}  // namespace pleat
