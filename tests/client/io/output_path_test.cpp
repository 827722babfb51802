#include "cli/io/output_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class OutputPathTest : public testing::Test {
 protected:
  void Make(const std::string& name) { ASSERT_THAT(WriteFile(File(name), "kept"), IsOk()); }
  std::string File(const std::string& name) const { return folder_.File(name); }
  absl::Status Check(const std::string& name, bool force = false) const {
    return CheckOutputFiles(SessionWith(force), {{"-o", File(name), {".json", ".glb"}}});
  }
  absl::Status CheckFolder(const std::string& name, bool force = false) const {
    return CheckOutputFolder(SessionWith(force), "--out", File(name));
  }
  absl::Status CheckAnimation(const std::string& name, const std::string& format,
                              bool force = false) const {
    return CheckAnimationOutput(SessionWith(force), File(name),
                                ChooseAnimationFormat(format, File(name)).value(), format);
  }
  static Session SessionWith(bool force) {
    Session session;
    session.force = force;
    return session;
  }
  static void ExpectUsageError(const absl::Status& status, const std::string& text) {
    EXPECT_TRUE(IsUsageError(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(text));
  }

  const TemporaryFolder folder_;
};

TEST_F(OutputPathTest, ReplacesAFileOnlyByForceAndNeverAnythingElse) {
  EXPECT_THAT(Check("new.json"), IsOk());
  Make("old.json");
  ExpectUsageError(Check("old.json"), File("old.json") + "' exists; --force");
  EXPECT_THAT(Check("old.json", true), IsOk());
  std::filesystem::create_symlink("nowhere", File("link.json"));
  ExpectUsageError(Check("link.json"), "exists");
  std::filesystem::create_directory(File("folder.json"));
  ExpectUsageError(Check("folder.json", true), "no regular file");
  ExpectUsageError(CheckOutputFiles(SessionWith(true), {{"-o", "/dev/null", {".json"}}}),
                   "/dev/null");
}

TEST_F(OutputPathTest, NamesTheKnownEndingsForAnUnknownOne) {
  ExpectUsageError(Check("x.fbx"), "'.fbx' is unknown here; known: .json, .glb");
  ExpectUsageError(Check("x.json.gz"), "'.gz'");
  EXPECT_THAT(Check("plain"), IsOk());
  EXPECT_THAT(CheckOutputFiles({}, {{"-o", "", {".json"}}}), IsOk());
}

TEST_F(OutputPathTest, TwoOutputsAreTwoFiles) {
  ExpectUsageError(CheckOutputFiles({}, {{"-o", File("a.json"), {".json"}},
                                         {"--report", File("./a.json"), {".json"}}}),
                   "-o and --report are the same file");
}

TEST_F(OutputPathTest, FoldersAreEmptyOrForced) {
  std::filesystem::create_directory(File("empty.XyZ"));
  EXPECT_THAT(CheckFolder("empty.XyZ"), IsOk());  // as mktemp names folders
  EXPECT_THAT(CheckFolder("new"), IsOk());
  EXPECT_THAT(CheckFolder("take.2"), IsOk());
  EXPECT_THAT(CheckFolder("new.glb/"), IsOk());
  ExpectUsageError(CheckFolder("new.glb"), "'.glb' is unknown");
  Make("full/file");
  ExpectUsageError(CheckFolder("full"), "not empty; --force");
  EXPECT_THAT(CheckFolder("full", true), IsOk());
  ExpectUsageError(CheckFolder("full/file", true), "no folder");
}

TEST_F(OutputPathTest, AnimationsKeepToTheirFormat) {
  for (const auto& [name, format] :
       {std::pair("x.pc2", "auto"), std::pair("x", "auto"), std::pair("x.drc", "drc"),
        std::pair("x", "pseq"), std::pair("x.glb", "auto"), std::pair("x.glb/", "auto")}) {
    EXPECT_THAT(CheckAnimation(name, format), IsOk()) << name << " as " << format;
  }
  ExpectUsageError(CheckAnimation("x.fbx", "auto"), "known: .pc2, .mdd, .abc");
  ExpectUsageError(CheckAnimation("x.pseq", "pc2"), "known: .pc2");
  ExpectUsageError(CheckAnimation("x.glb", "obj"), "'.glb' is unknown");
  Make("x.obj");  // the mesh that goes with x.pc2
  ExpectUsageError(CheckAnimation("x.pc2", "auto"), "x.obj' exists");
  EXPECT_THAT(CheckAnimation("x.pc2", "auto", true), IsOk());
  ExpectUsageError(CheckAnimation("x.obj", "obj", true), "no folder");
}

// Every verb refuses before it looks at its input, which does not exist here.
TEST_F(OutputPathTest, EveryVerbRefusesToReplaceAFileBeforeItReads) {
  for (const char* name : {"a.json", "a.pleat", "a.plt", "a.png", "a.pc2", "full/file"}) Make(name);
  const std::string json = File("a.json"), model = File("a.pleat"), none = File("none");
  const std::vector<std::vector<std::string>> commands = {
      {"rig", none, "-o", json},
      {"rig", none, "--report", json},
      {"train", none, "--local", "-o", model},
      {"train", none, "--report", json},
      {"motion", none, none, "-o", json},
      {"pose", none, "--motion", none, "-o", File("a.pc2")},
      {"pose", none, "--motion", none, "-o", File("full")},
      {"evaluate", none, "--report", json},
      {"evaluate", none, "--experiment", "resolutions", "--out", File("full")},
      {"render", none, "-o", File("a.png")},
      {"compress", none, "--kg", "1", "-o", File("a.plt")},
      {"compress", none, "--kg", "1", "-o", File("b.plt"), "--report", json},
      {"decompress", none, "-o", File("a.pc2")},
      {"generate", "performer", "-o", File("full")},
      {"models", "download", "a", "-o", model},
      {"compressed", "download", "a", "-o", File("a.plt")},
      {"bench", "a", "--report", json},
      {"bench", "a", "--plot", File("a.png")}};
  for (const std::vector<std::string>& command : commands) {
    const Outcome outcome = RunPleat(command);
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << testing::PrintToString(command);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--force"), HasSubstr(folder_.path())))
        << testing::PrintToString(command);
  }
  EXPECT_EQ(ReadFile(model).value(), "kept");
}

TEST_F(OutputPathTest, EveryVerbRefusesAnUnknownEndingBeforeItReads) {
  const std::string none = File("none"), out = File("x.fbx");
  const std::vector<std::pair<std::vector<std::string>, std::string>> commands = {
      {{"rig", none}, ".json"},
      {{"train", none}, ".pleat"},
      {{"motion", none, none}, ".json"},
      {{"pose", none, "--motion", none}, ".pc2, .mdd, .abc"},
      {{"render", none}, ".png"},
      {{"compress", none, "--kg", "1"}, ".plt"},
      {{"decompress", none}, ".pc2, .mdd, .abc"},
      {{"generate", "performer"}, "none"},
      {{"models", "download", "a"}, ".pleat"},
      {{"compressed", "download", "a"}, ".plt"}};
  for (auto [command, known] : commands) {
    command.insert(command.end(), {"-o", out});
    const Outcome outcome = RunPleat(command);
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << testing::PrintToString(command);
    EXPECT_THAT(outcome.err, HasSubstr("'.fbx' is unknown here; known: " + known));
  }
}

}  // namespace
}  // namespace pleat
