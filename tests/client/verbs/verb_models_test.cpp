#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ModelsVerbTest, ListsShowsDownloadsAndDeletes) {
  const TubeFiles files;
  const std::string trained = files.File("trained.pleat");
  ASSERT_EQ(files.TrainInStore({"-q", "-o", trained}).code, ExitCode::kOk);
  const auto list = nlohmann::json::parse(files.RunInStore({"models", "--json"}).out);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["name"], "tube");
  EXPECT_EQ(list[0]["learner"], "ridge");
  EXPECT_EQ(list[0]["num_vertices"], TubeFiles::kNumVertices);
  EXPECT_EQ(list[0]["num_training_frames"], TubeFiles::kNumFrames);
  EXPECT_EQ(list[0]["size_bytes"], ReadFile(trained).value().size());
  ASSERT_EQ(list[0]["joints"].size(), 3u);
  EXPECT_EQ(list[0]["joints"][2]["name"], "head");
  const std::string id = list[0]["id"];

  EXPECT_THAT(
      files.RunInStore({"models"}).out,
      testing::AllOf(HasSubstr("error %"), HasSubstr(id.substr(0, 12)), HasSubstr("ridge")));
  EXPECT_EQ(nlohmann::json::parse(files.RunInStore({"models", "show", id.substr(0, 4)}).out),
            list[0]);
  const std::string copy = files.File("copy.pleat");
  ASSERT_EQ(files.RunInStore({"models", "download", id, "-o", copy, "-q"}).code, ExitCode::kOk);
  EXPECT_EQ(ReadFile(copy).value(), ReadFile(trained).value());

  ASSERT_EQ(files.RunInStore({"models", "delete", id}).code, ExitCode::kOk);
  EXPECT_EQ(files.RunInStore({"models", "--json"}).out, "[]\n");
  EXPECT_EQ(files.RunInStore({"models", "delete", id}).code, ExitCode::kNotFound);
}

TEST(ModelsVerbTest, UnknownActionsAndMissingIdsAreUsageErrors) {
  const TubeFiles files;
  EXPECT_EQ(files.RunInStore({"models", "rename"}).code, ExitCode::kUsage);
  for (const char* action : {"show", "delete", "download"}) {
    const Outcome outcome = files.RunInStore({"models", action});
    EXPECT_EQ(outcome.code, ExitCode::kUsage);
    EXPECT_THAT(outcome.err, HasSubstr(std::string("pleat models: '") + action + "' needs an id"));
  }
}

}  // namespace
}  // namespace pleat
