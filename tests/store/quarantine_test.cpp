#include "pleat/store/quarantine.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "pleat/base/file.h"
#include "store/sync_gate.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::MatchesRegex;

class QuarantineTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& bytes) {
    EXPECT_THAT(WriteFile(folder_.File(name), bytes), IsOk());
    return folder_.File(name);
  }

  TemporaryFolder folder_;
  SyncGate gate_;
  Quarantine quarantine_{folder_.File("quarantine"), gate_.hook()};
};

TEST_F(QuarantineTest, KeepsTheFileAndWritesDownWhy) {
  EXPECT_TRUE(quarantine_.List()->empty());
  const std::string path = Write("blobs/ab/file", "content");
  ASSERT_THAT(quarantine_.Take(path, "nobody\tknows\nit"), IsOk());
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(ReadFile(folder_.File("quarantine/file")).value(), "content");
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto files, quarantine_.List());
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].name, "file");
  EXPECT_EQ(files[0].size_bytes, 7u);
  EXPECT_EQ(files[0].reason, "nobody\\x09knows\\x0ait");
  EXPECT_THAT(files[0].time, MatchesRegex("20[0-9-]+T[0-9:]+Z"));
}

TEST_F(QuarantineTest, TheManifestIsDurableBeforeTheFileMoves) {
  const std::string path = Write("blobs/ab/file", "content");
  gate_.TakePaths();
  ASSERT_THAT(quarantine_.Take(path, "why"), IsOk());
  EXPECT_THAT(gate_.TakePaths(), ElementsAre(folder_.File("quarantine/manifest.tsv"),
                                             folder_.File("quarantine"), folder_.File("blobs/ab")));
}

TEST_F(QuarantineTest, TwoFilesOfOneNameAreBothKept) {
  ASSERT_THAT(quarantine_.Take(Write("a/file", "first"), "one"), IsOk());
  ASSERT_THAT(quarantine_.Take(Write("b/file", "second"), "two"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto files, quarantine_.List());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[1].name, "file.2");
  EXPECT_EQ(files[1].reason, "two");
  EXPECT_EQ(ReadFile(folder_.File("quarantine/file")).value(), "first");
  EXPECT_EQ(ReadFile(folder_.File("quarantine/file.2")).value(), "second");
}

TEST_F(QuarantineTest, WhatSomebodyElsePutThereIsListedWithoutReason) {
  Write("quarantine/other", "x");
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto files, quarantine_.List());
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].reason, "");
  EXPECT_EQ(files[0].time, "");
}

TEST_F(QuarantineTest, AFileThatCannotMoveStays) {
  Write("quarantine", "a file where the folder should be");
  const std::string path = Write("blobs/ab/file", "content");
  EXPECT_FALSE(quarantine_.Take(path, "why").ok());
  EXPECT_EQ(ReadFile(path).value(), "content");
}

TEST_F(QuarantineTest, AManifestThatBreaksOffIsReadAsFarAsItGoes) {
  ASSERT_THAT(quarantine_.Take(Write("a/one", "1"), "first"), IsOk());
  const std::string manifest = ReadFile(folder_.File("quarantine/manifest.tsv")).value();
  Write("quarantine/manifest.tsv", manifest + "two\t2026");
  Write("quarantine/two", "2");
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto files, quarantine_.List());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].reason, "first");
  EXPECT_EQ(files[1].reason, "");
}

}  // namespace
}  // namespace pleat
