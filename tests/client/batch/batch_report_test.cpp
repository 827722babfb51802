#include "cli/batch/batch_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

BatchRow MakeRow(const std::string& name, absl::Status status = absl::OkStatus()) {
  return {.name = name,
          .inputs = {"/data/" + name + ".pc2"},
          .fingerprint = "f1",
          .status = std::move(status),
          .sequence_ids = {"s"},
          .job_id = "j",
          .result_id = "r",
          .output = "out/" + name + ".pleat",
          .num_frames = 40,
          .num_vertices = 1500,
          .mean_error_mm = 1.25,
          .seconds = 12.5};
}

TEST(BatchReportTest, ARowComesBackAsItWas) {
  for (const absl::Status& status :
       {absl::OkStatus(), absl::NotFoundError("file 'a\n\xff' is not there")}) {
    const BatchRow row = MakeRow("take \"1\"", status);
    const std::string line = FormatBatchRow(row);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    PLEAT_ASSERT_OK_AND_ASSIGN(const BatchRow back, ParseBatchRow(line));
    EXPECT_EQ(back.name, row.name);
    EXPECT_EQ(back.inputs, row.inputs);
    EXPECT_EQ(back.fingerprint, row.fingerprint);
    EXPECT_EQ(back.status.code(), row.status.code());
    EXPECT_EQ(back.result_id, row.result_id);
    EXPECT_EQ(back.output, row.output);
    EXPECT_EQ(back.num_vertices, 1500);
    EXPECT_EQ(back.mean_error_mm, 1.25);
    EXPECT_EQ(FormatBatchRow(back), line);
  }
}

TEST(BatchReportTest, OtherLinesAreRefused) {
  for (const char* line : {"", "{}", "[]", "null", R"({"schema":"pleat.batch/1"})",
                           R"({"schema":"pleat.batch/2","name":"a"})", "\xff\xfe"}) {
    EXPECT_THAT(ParseBatchRow(line), HasStatus(absl::StatusCode::kDataLoss, testing::_)) << line;
  }
}

TEST(BatchReportTest, ALaterRunKnowsWhatWasDone) {
  const TemporaryFolder folder;
  const std::string path = folder.File("report.jsonl");
  {
    const auto report = BatchReport::Open(path).value();
    EXPECT_FALSE(report->IsDone("walk", "f1"));
    EXPECT_THAT(report->Add(MakeRow("walk")), IsOk());
    EXPECT_THAT(report->Add(MakeRow("run", absl::InternalError("no"))), IsOk());
    EXPECT_THAT(report->Add(MakeRow("run", absl::InternalError("no"))), IsOk());
  }
  const auto report = BatchReport::Open(path).value();
  EXPECT_TRUE(report->IsDone("walk", "f1"));
  EXPECT_FALSE(report->IsDone("walk", "other")) << "inputs or options have changed";
  EXPECT_FALSE(report->IsDone("run", "f1"));
  EXPECT_EQ(report->NumFailures("run", "f1"), 2);
  EXPECT_EQ(report->NumFailures("walk", "f1"), 0);
}

TEST(BatchReportTest, ALineThatACrashHasCutOffIsOverwritten) {
  const TemporaryFolder folder;
  const std::string path = folder.File("report.jsonl");
  const std::string whole = FormatBatchRow(MakeRow("walk")) + "\n";
  ASSERT_THAT(WriteFile(path, whole + whole.substr(0, 50)), IsOk());
  {
    const auto report = BatchReport::Open(path).value();
    EXPECT_TRUE(report->IsDone("walk", "f1"));
    EXPECT_THAT(report->Add(MakeRow("run")), IsOk());
  }
  EXPECT_EQ(ReadFile(path).value(), whole + FormatBatchRow(MakeRow("run")) + "\n");
}

TEST(BatchReportTest, AFileOfSomethingElseIsNotTouched) {
  const TemporaryFolder folder;
  const std::string path = folder.File("notes.txt");
  ASSERT_THAT(WriteFile(path, "my notes\nand more\n"), IsOk());
  EXPECT_THAT(BatchReport::Open(path), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("line 1")));
  EXPECT_EQ(ReadFile(path).value(), "my notes\nand more\n");
}

TEST(BatchErrorTableTest, RefusalsComeFirstAndLikeErrorsAreOne) {
  std::vector<BatchRow> rows = {MakeRow("fine")};
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(10 * i);
    rows.push_back(
        MakeRow("lost" + number, absl::NotFoundError("'take" + number + ".pc2' is not there")));
    rows.push_back(MakeRow("down" + number, absl::UnavailableError("no answer")));
  }
  rows.push_back(MakeRow("horse", absl::FailedPreconditionError("no human-like rig, 41 %")));
  const std::string table = BatchErrorTable(rows);
  const size_t refusal = table.find("no human-like rig"), lost = table.find("'take0.pc2'");
  EXPECT_LT(refusal, lost);
  EXPECT_LT(lost, table.find("no answer"));
  EXPECT_EQ(table.find("take10"), std::string::npos) << table;
  EXPECT_THAT(table, HasSubstr("3"));
  EXPECT_EQ(BatchErrorTable({MakeRow("fine")}), "");
}

}  // namespace
}  // namespace pleat
