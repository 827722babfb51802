#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(SequencesVerbTest, ListsShowsAndDeletes) {
  const TubeFiles files;
  EXPECT_EQ(files.RunInStore({"sequences", "--json"}).out, "[]\n");
  ASSERT_EQ(files.RunInStore({"upload", files.sequence_path(), "-q"}).code, ExitCode::kOk);
  const auto list = nlohmann::json::parse(files.RunInStore({"sequences", "--json"}).out);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["name"], "tube");
  EXPECT_EQ(list[0]["num_frames"], TubeFiles::kNumFrames);
  EXPECT_EQ(list[0]["num_vertices"], TubeFiles::kNumVertices);
  EXPECT_EQ(list[0]["num_faces"], 88);
  EXPECT_EQ(list[0]["fps"], 25);
  const std::string id = list[0]["id"];
  EXPECT_THAT(
      files.RunInStore({"sequences"}).out,
      testing::AllOf(HasSubstr("vertices"), HasSubstr(id.substr(0, 12)), HasSubstr("tube")));
  EXPECT_EQ(nlohmann::json::parse(files.RunInStore({"sequences", "show", id.substr(0, 5)}).out),
            list[0]);
  ASSERT_EQ(files.RunInStore({"sequences", "delete", id.substr(0, 5)}).code, ExitCode::kOk);
  EXPECT_EQ(files.RunInStore({"sequences", "--json"}).out, "[]\n");
}

TEST(SequencesVerbTest, SaysHowLongASequenceIsKept) {
  const TubeFiles files;
  ASSERT_EQ(files.RunInStore({"upload", files.sequence_path(), "-q", "--ttl-hours", "1"}).code,
            ExitCode::kOk);
  const auto only = [&] {
    return nlohmann::json::parse(files.RunInStore({"sequences", "--json"}).out).at(0);
  };
  const std::string id = only()["id"], expires = only()["expires"];
  EXPECT_GT(expires, only()["created"].get<std::string>());
  EXPECT_FALSE(only().contains("pinned"));
  ASSERT_EQ(files.RunInStore({"sequences", "pin", id.substr(0, 5)}).code, ExitCode::kOk);
  EXPECT_EQ(only()["pinned"], true);
  EXPECT_THAT(files.RunInStore({"sequences"}).out, HasSubstr("pinned"));
  ASSERT_EQ(files.RunInStore({"sequences", "unpin", id}).code, ExitCode::kOk);
  EXPECT_FALSE(only().contains("pinned"));
  ASSERT_EQ(files.RunInStore({"upload", files.sequence_path(), "-q"}).code, ExitCode::kOk);
  EXPECT_FALSE(only().contains("expires"));  // for ever
}

TEST(SequencesVerbTest, SequencesAreNotDownloaded) {
  const TubeFiles files;
  const Outcome outcome = files.RunInStore({"sequences", "download", "5e"});
  EXPECT_EQ(outcome.code, ExitCode::kUsage);
  EXPECT_THAT(outcome.err, HasSubstr("Try 'pleat sequences --help'."));
}

TEST(SequencesVerbTest, UnknownIdsAreNotFound) {
  const TubeFiles files;
  for (const char* action : {"show", "delete", "pin", "unpin"}) {
    const Outcome outcome = files.RunInStore({"sequences", action, "5e"});
    EXPECT_EQ(outcome.code, ExitCode::kNotFound) << action;
    EXPECT_THAT(outcome.err, HasSubstr("there is no sequence 5e")) << action;
  }
}

}  // namespace
}  // namespace pleat
