#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class CompressedVerbTest : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome made = files_.RunInStore(
        {"compress", files_.sequence_path(), "-o", path_, "--max-error-mm", "1", "--quiet"});
    ASSERT_EQ(made.code, ExitCode::kOk) << made.err;
  }

  const TubeFiles files_;
  const std::string path_ = files_.File("tube.plt");
};

TEST_F(CompressedVerbTest, ListsShowsDownloadsAndDeletes) {
  const auto list = nlohmann::json::parse(files_.RunInStore({"compressed", "--json"}).out);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["num_frames"], TubeFiles::kNumFrames);
  EXPECT_EQ(list[0]["num_vertices"], TubeFiles::kNumVertices);
  EXPECT_EQ(list[0]["options"]["max_error_mm"], 1);
  const std::string id = list[0]["id"];

  const Outcome table = files_.RunInStore({"compressed", "list"});
  EXPECT_THAT(table.out, HasSubstr("max mm"));
  EXPECT_THAT(table.out, HasSubstr(id.substr(0, 12)));

  // The first digits are enough.
  const Outcome shown = files_.RunInStore({"compressed", "show", id.substr(0, 6)});
  EXPECT_EQ(nlohmann::json::parse(shown.out), list[0]);
  const std::string copy = files_.File("copy.plt");
  ASSERT_EQ(files_.RunInStore({"compressed", "download", id, "-o", copy, "-q"}).code,
            ExitCode::kOk);
  EXPECT_EQ(ReadFile(copy).value(), ReadFile(path_).value());

  ASSERT_EQ(files_.RunInStore({"compressed", "delete", id}).code, ExitCode::kOk);
  EXPECT_EQ(files_.RunInStore({"compressed", "--json"}).out, "[]\n");
  const Outcome gone = files_.RunInStore({"compressed", "show", id});
  EXPECT_EQ(gone.code, ExitCode::kNotFound);
  EXPECT_THAT(gone.err, HasSubstr("pleat compressed: there is no compressed sequence " + id));
}

TEST_F(CompressedVerbTest, ActionsThatLackSomethingAreUsageErrors) {
  const Outcome no_id = files_.RunInStore({"compressed", "show"});
  EXPECT_EQ(no_id.code, ExitCode::kUsage);
  EXPECT_THAT(no_id.err, HasSubstr("'show' needs an id"));
  const auto list = nlohmann::json::parse(files_.RunInStore({"compressed", "--json"}).out);
  const Outcome no_output =
      files_.RunInStore({"compressed", "download", list[0]["id"].get<std::string>()});
  EXPECT_EQ(no_output.code, ExitCode::kUsage);
  EXPECT_THAT(no_output.err, HasSubstr("'download' needs -o FILE"));
  EXPECT_EQ(files_.RunInStore({"compressed", "burn"}).code, ExitCode::kUsage);
}

}  // namespace
}  // namespace pleat
