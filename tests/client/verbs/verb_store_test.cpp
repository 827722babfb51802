#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class StoreVerbTest : public testing::Test {
 protected:
  StoreVerbTest() {
    EXPECT_THAT(WriteSequenceFile(folder_.File("in.pseq"), MovingTetrahedron(3)), IsOk());
    EXPECT_EQ(RunPleat({"upload", folder_.File("in.pseq"), "--local", "--data-dir", data_}).code,
              ExitCode::kOk);
  }
  Outcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "store");
    return RunPleat(arguments);
  }
  json RunJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return json::parse(Run(std::move(arguments)).out);
  }
  std::string StoredFile() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data_ + "/blobs")) {
      if (entry.path().filename().string().size() == 64) return entry.path();
    }
    return "";
  }

  TemporaryFolder folder_;
  const std::string data_ = folder_.File("data"), backup_ = folder_.File("backup");
};

TEST_F(StoreVerbTest, ASoundStoreIsChecked) {
  const Outcome outcome = Run({"check", data_, "-q"});
  EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("sequences            1"), HasSubstr("store")));
  const json check = RunJson({"check", data_});
  EXPECT_EQ(check["entries"]["sequence"], 1);
  EXPECT_EQ(check["files"], 1);
  EXPECT_TRUE(check["problems"].empty());
  EXPECT_EQ(check["store_id"].get<std::string>().size(), 32u);
}

TEST_F(StoreVerbTest, DamageEndsWithItsExitCodeAndIsNamed) {
  ASSERT_THAT(WriteFile(StoredFile(), "damaged"), IsOk());
  EXPECT_EQ(Run({"check", data_, "--fast", "-q"}).code, ExitCode::kOk);
  const Outcome outcome = Run({"check", data_, "-q"});
  EXPECT_EQ(outcome.code, ExitCode::kRefused);
  EXPECT_THAT(outcome.out, HasSubstr("damaged file"));
  EXPECT_THAT(outcome.err, HasSubstr("1 problem"));
  EXPECT_EQ(RunJson({"check", data_})["problems"][0]["kind"], "damaged file");
}

TEST_F(StoreVerbTest, ABackupIsMadeRenewedAndRestored) {
  EXPECT_EQ(RunJson({"backup", data_, backup_})["copied_files"], 1);
  const Outcome again = Run({"backup", data_, backup_, "-q"});
  EXPECT_EQ(again.code, ExitCode::kOk);
  EXPECT_THAT(again.out, HasSubstr("files copied: 0 (0 B), already there: 1"));
  EXPECT_EQ(Run({"restore", backup_, data_, "-q"}).code, ExitCode::kRefused);  // not empty
  std::filesystem::remove_all(data_);
  EXPECT_EQ(Run({"restore", backup_, data_, "-q"}).code, ExitCode::kOk);
  EXPECT_EQ(Run({"check", data_, "-q"}).code, ExitCode::kOk);
  EXPECT_THAT(RunPleat({"sequences", "list", "--local", "--data-dir", data_}).out,
              HasSubstr("tetrahedron"));
}

// The catalog is gone, and the files say what they are.
TEST_F(StoreVerbTest, ALostCatalogIsRepaired) {
  std::filesystem::remove(data_ + "/catalogue.db");
  const Outcome refused = RunPleat({"sequences", "list", "--local", "--data-dir", data_});
  EXPECT_EQ(refused.code, ExitCode::kRefused);
  EXPECT_THAT(refused.err, HasSubstr("pleat store repair"));
  const Outcome repaired = Run({"repair", data_, "-q"});
  EXPECT_EQ(repaired.code, ExitCode::kOk) << repaired.err;
  EXPECT_THAT(repaired.out, HasSubstr(std::filesystem::path(StoredFile()).filename().string()));
  EXPECT_THAT(RunPleat({"sequences", "list", "--local", "--data-dir", data_}).out,
              HasSubstr("tetrahedron"));
  EXPECT_TRUE(RunJson({"repair", data_})["rows_made"].empty());
}

TEST_F(StoreVerbTest, AScrubMovesDamageToTheQuarantine) {
  EXPECT_TRUE(RunJson({"scrub", data_})["problems"].empty());
  const std::string id = std::filesystem::path(StoredFile()).filename();
  ASSERT_THAT(WriteFile(StoredFile(), "damaged"), IsOk());
  const Outcome outcome = Run({"scrub", data_, "-q"});
  EXPECT_EQ(outcome.code, ExitCode::kRefused);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr(id), HasSubstr("quarantine")));
  EXPECT_EQ(StoredFile(), "");
  EXPECT_TRUE(std::filesystem::exists(data_ + "/quarantine/" + id));
}

TEST_F(StoreVerbTest, ASweepRemovesWhatHasLivedOutItsTime) {
  EXPECT_TRUE(RunJson({"sweep", data_, "--keep-jobs", "1"})["removed"].empty());
  const std::vector<std::string> local = {"--local", "--data-dir", data_};
  EXPECT_THAT(WriteSequenceFile(folder_.File("brief.pseq"), MovingTetrahedron(4)), IsOk());
  std::vector<std::string> upload = {"upload", folder_.File("brief.pseq"), "--ttl-hours", "1e-9"};
  upload.insert(upload.end(), local.begin(), local.end());
  ASSERT_EQ(RunPleat(upload).code, ExitCode::kOk);
  const json swept = RunJson({"sweep", data_});
  ASSERT_EQ(swept["removed"].size(), 1u);
  EXPECT_THAT(swept["removed"][0].get<std::string>(), HasSubstr("time to live"));
  const json check = RunJson({"check", data_});
  EXPECT_EQ(check["entries"]["sequence"], 1);
  EXPECT_EQ(check["files"], 1);
  EXPECT_TRUE(check["problems"].empty());
}

TEST_F(StoreVerbTest, WhatIsMissingIsAMistakeOfTheCommandLine) {
  EXPECT_EQ(Run({"check"}).code, ExitCode::kUsage);
  EXPECT_EQ(Run({"polish", data_}).code, ExitCode::kUsage);
  EXPECT_EQ(Run({"backup", data_}).code, ExitCode::kUsage);
  EXPECT_EQ(Run({"check", data_, backup_}).code, ExitCode::kUsage);
  for (const char* action : {"check", "scrub", "sweep"}) {
    EXPECT_EQ(Run({action, folder_.File("missing"), "-q"}).code, ExitCode::kNotFound) << action;
    EXPECT_FALSE(std::filesystem::exists(folder_.File("missing"))) << action;
  }
}

}  // namespace
}  // namespace pleat
