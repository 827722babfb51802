#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "absl/strings/str_split.h"
#include "cli/batch/batch_report.h"
#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Two good takes and one that is not there.
class BatchVerbTest : public testing::Test {
 protected:
  BatchVerbTest() {
    std::filesystem::create_directories(files_.File("b"));
    std::filesystem::copy_file(files_.sequence_path(), files_.File("b/tube.pseq"));
    EXPECT_THAT(WriteFile(list_, "tube.pseq\nb/tube.pseq\nmissing.pseq\n"), IsOk());
  }
  Outcome Compress(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"batch", list_, "-o", out_, "--max-error-mm", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return files_.RunInStore(arguments);
  }

  const TubeFiles files_;
  const std::string list_ = files_.File("list.txt"), out_ = files_.File("out");
};

TEST_F(BatchVerbTest, WhatCanBeDoneIsDoneAndTheRestIsSaid) {
  const Outcome outcome = Compress();
  EXPECT_EQ(outcome.code, ExitCode::kRefused) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("3 takes: 2 done, 0 were done before, 1 failed"));
  EXPECT_THAT(outcome.out, HasSubstr("missing"));
  EXPECT_TRUE(std::filesystem::exists(out_ + "/b_tube.plt"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out_), {}), 3);
  const std::string report = ReadFile(out_ + "/batch.jsonl").value();
  const std::vector<std::string> lines = absl::StrSplit(report, '\n', absl::SkipEmpty());
  EXPECT_EQ(lines.size(), 3u);
  for (const std::string& line : lines) EXPECT_THAT(ParseBatchRow(line), IsOk()) << line;
}

TEST_F(BatchVerbTest, ALaterRunGoesOn) {
  Compress();
  EXPECT_THAT(WriteFile(files_.File("missing.pseq"), ReadFile(files_.sequence_path()).value()),
              IsOk());
  const Outcome outcome = Compress({"--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary["num_done"], 1);
  EXPECT_EQ(summary["num_done_before"], 2);
  EXPECT_EQ(summary["num_failed"], 0);
  EXPECT_EQ(Compress({"-q"}).code, ExitCode::kOk);
}

TEST_F(BatchVerbTest, CommandLinesThatLackSomethingAreUsageErrors) {
  EXPECT_EQ(files_.RunInStore({"batch", list_}).code, ExitCode::kUsage);
  const Outcome both = Compress({"--learner", "gp"});
  EXPECT_EQ(both.code, ExitCode::kUsage);
  EXPECT_THAT(both.err, HasSubstr("one of the two"));
  EXPECT_EQ(Compress({"--kg", "1"}).code, ExitCode::kUsage);
  EXPECT_THAT(WriteFile(list_, "# empty\n"), IsOk());
  const Outcome empty = Compress();
  EXPECT_EQ(empty.code, ExitCode::kBadInput);
  EXPECT_THAT(empty.err, HasSubstr("list.txt"));
}

}  // namespace
}  // namespace pleat
