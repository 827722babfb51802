#include "cli/batch/batch_work.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

class FingerprintTest : public testing::Test {
 protected:
  FingerprintTest() {
    EXPECT_THAT(WriteFile(file_, "one"), IsOk());
    std::filesystem::create_directory(folder_.File("frames"));
    EXPECT_THAT(WriteFile(folder_.File("frames/1.obj"), "one"), IsOk());
  }
  std::string Of(const std::string& input) const {
    return FingerprintOf({.name = "n", .inputs = {input}, .line = 1}, job_);
  }
  // Sets a time of change that no clock gives by chance.
  void Touch(const std::string& path) const {
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::hours(1));
  }

  const TemporaryFolder folder_;
  const std::string file_ = folder_.File("a.pc2");
  BatchJob job_{.options = TrainOptions()};
};

TEST_F(FingerprintTest, TheSameInputAndOptionsAreTheSame) {
  EXPECT_EQ(Of(file_), Of(file_));
  EXPECT_EQ(Of("missing"), Of("missing"));
  EXPECT_NE(Of(file_), Of("missing"));
}

TEST_F(FingerprintTest, AFileThatChangesIsAnother) {
  const std::string before = Of(file_);
  Touch(file_);
  EXPECT_NE(Of(file_), before);
}

TEST_F(FingerprintTest, AFolderChangesWithItsFrames) {
  const std::string folder = folder_.File("frames"), before = Of(folder);
  EXPECT_THAT(WriteFile(folder_.File("frames/2.obj"), "two"), IsOk());
  const std::string more = Of(folder);
  EXPECT_NE(more, before);
  Touch(folder_.File("frames/2.obj"));
  EXPECT_NE(Of(folder), more);
}

TEST_F(FingerprintTest, OtherOptionsAreAnotherJob) {
  const std::string before = Of(file_);
  TrainOptions train;
  train.history = 3;
  job_.options = train;
  const std::string trained = Of(file_);
  EXPECT_NE(trained, before);
  job_.options = CompressOptions{.max_error_mm = 2};
  const std::string compressed = Of(file_);
  EXPECT_NE(compressed, trained);
  job_.options = CompressOptions{.max_error_mm = 3};
  EXPECT_NE(Of(file_), compressed);
}

}  // namespace
}  // namespace pleat
