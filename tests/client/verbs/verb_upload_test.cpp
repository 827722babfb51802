#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(UploadVerbTest, PrintsTheIdThatInspectComputes) {
  const TubeFiles files;
  const Outcome uploaded = files.RunInStore({"upload", files.sequence_path()});
  ASSERT_EQ(uploaded.code, ExitCode::kOk) << uploaded.err;
  const auto inspected =
      nlohmann::json::parse(RunPleat({"inspect", files.sequence_path(), "--json"}).out);
  EXPECT_EQ(uploaded.out, inspected["sequence_id"].get<std::string>() + "\n");
}

TEST(UploadVerbTest, TheSameContentIsStoredOnce) {
  const TubeFiles files;
  const std::string copy = files.File("copy.pseq");
  ASSERT_THAT(WriteFile(copy, ReadFile(files.sequence_path()).value()), IsOk());
  const Outcome first = files.RunInStore({"upload", files.sequence_path(), "--json"});
  const Outcome second = files.RunInStore({"upload", copy, "--json"});
  EXPECT_EQ(nlohmann::json::parse(first.out)["id"], nlohmann::json::parse(second.out)["id"]);
  EXPECT_EQ(nlohmann::json::parse(files.RunInStore({"sequences", "--json"}).out).size(), 1u);
}

TEST(UploadVerbTest, ForgetsWhatHasArrived) {
  const TubeFiles files;
  const std::vector<std::string> forget = {"upload", files.sequence_path(), "--forget", "-q"};
  EXPECT_EQ(files.RunInStore(forget).code, ExitCode::kNotFound);
  ASSERT_EQ(files.RunInStore({"upload", files.sequence_path(), "-q"}).code, ExitCode::kOk);
  const auto list = nlohmann::json::parse(files.RunInStore({"sequences", "--json"}).out);
  const std::string path =
      files.File("store/uploads/") + list[0]["id"].get<std::string>() + ".part";
  std::ofstream(path) << "some bytes";
  EXPECT_EQ(files.RunInStore(forget).code, ExitCode::kOk);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(nlohmann::json::parse(files.RunInStore({"sequences", "--json"}).out).size(), 1u);
}

TEST(UploadVerbTest, MissingInputsReachNoService) {
  const Outcome outcome = RunPleat({"upload", "/nowhere/x.pseq", "--server", "127.0.0.1:1"});
  EXPECT_EQ(outcome.code, ExitCode::kNotFound);
  EXPECT_THAT(outcome.err, HasSubstr("pleat upload: "));
  EXPECT_THAT(outcome.err, HasSubstr("/nowhere/x.pseq"));
}

TEST(UploadVerbTest, AServerThatIsNotThereIsUnavailable) {
  const TubeFiles files;
  const Outcome outcome =
      RunPleat({"upload", files.sequence_path(), "--server", "127.0.0.1:1", "-q"});
  EXPECT_EQ(outcome.code, ExitCode::kUnavailable);
  EXPECT_THAT(outcome.err, HasSubstr("127.0.0.1:1"));
}

}  // namespace
}  // namespace pleat
