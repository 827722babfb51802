#include "cli/show/command_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

using testing::ElementsAre;

TEST(CommandTreeTest, VerbsAndFlagsAreThoseOfTheParser) {
  CLI::App app("a program", "pleat");
  CLI::App* motion = app.add_subcommand("motion", "moves");
  CLI::App* edit = motion->add_subcommand("edit", "edits");
  std::string input, output;
  bool quiet = false;
  edit->add_option("FILE", input, "what is edited")->required();
  edit->add_option("-o,--output", output, "where it goes");
  edit->add_flag("--quiet,-q", quiet, "says less");
  const Command program = ReadCommand(app);
  EXPECT_EQ(program.description, "a program");
  ASSERT_EQ(program.verbs.size(), 1u);
  ASSERT_EQ(program.verbs[0].verbs.size(), 1u);
  const Command& command = program.verbs[0].verbs[0];
  EXPECT_THAT(command.path, ElementsAre("motion", "edit"));
  ASSERT_EQ(command.flags.size(), 3u);
  EXPECT_EQ(command.flags[0].positional, "FILE");
  EXPECT_TRUE(command.flags[0].required);
  EXPECT_TRUE(command.flags[0].names.empty());
  EXPECT_THAT(command.flags[1].names, ElementsAre("-o", "--output"));
  EXPECT_FALSE(command.flags[1].value.empty());
  EXPECT_THAT(command.flags[2].names, ElementsAre("-q", "--quiet"));
  EXPECT_EQ(command.flags[2].value, "");
  std::vector<size_t> depths;
  ForCommands(program, [&](const Command& c) { depths.push_back(c.path.size()); });
  EXPECT_THAT(depths, ElementsAre(0, 1, 2));
}

}  // namespace
}  // namespace pleat
