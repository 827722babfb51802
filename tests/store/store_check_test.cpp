#include "pleat/store/store_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "store/sample_store.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = StoreProblem::Kind;

auto Problem(Kind kind, const std::string& bytes) {
  return AllOf(Field(&StoreProblem::kind, kind), Field(&StoreProblem::id, IdOf(bytes)),
               Field(&StoreProblem::text, HasSubstr(IdOf(bytes))));
}

class StoreCheckTest : public testing::Test {
 protected:
  StoreCheck Check(bool verify_files = true) {
    absl::StatusOr<StoreCheck> check = CheckStore(sample_.data_dir(), verify_files);
    EXPECT_THAT(check, IsOk());
    return check.value_or(StoreCheck());
  }
  SampleStore sample_;
};

TEST_F(StoreCheckTest, CountsWhatIsThere) {
  const StoreCheck check = Check();
  EXPECT_THAT(check.problems, IsEmpty());
  EXPECT_THAT(check.quarantine, IsEmpty());
  EXPECT_EQ(check.store_id.size(), 32u);
  EXPECT_EQ(check.num_entries[static_cast<size_t>(EntryKind::kSequence)], 3u);
  EXPECT_EQ(check.num_entries[static_cast<size_t>(EntryKind::kJob)], 1u);
  EXPECT_EQ(check.num_files, 3u);
  EXPECT_EQ(check.num_bytes, 4u + 3 + 3);
}

TEST_F(StoreCheckTest, WorksBesideAServer) {
  const auto store = sample_.Open();
  EXPECT_THAT(Check().problems, IsEmpty());
  SampleStore::Add(store.get(), "three");
  EXPECT_EQ(Check().num_files, 4u);
}

TEST_F(StoreCheckTest, NamesEachProblem) {
  sample_.Damage("zero");
  sample_.Remove("one");
  sample_.BreakRow("two");
  const std::string unknown = IdOf("unknown");
  ASSERT_THAT(WriteFile(sample_.PathOf("unknown"), "unknown"), IsOk());
  EXPECT_THAT(
      Check().problems,
      ElementsAre(Problem(Kind::kBadRow, "two"), Problem(Kind::kMissingFile, "one"),
                  Problem(Kind::kDamagedFile, "zero"), Problem(Kind::kUnknownFile, "unknown")));
  // Without reading the files, the damage is not seen.
  EXPECT_THAT(Check(false).problems,
              ElementsAre(Problem(Kind::kBadRow, "two"), Problem(Kind::kMissingFile, "one"),
                          Problem(Kind::kUnknownFile, "unknown")));
}

TEST_F(StoreCheckTest, ChangesNothing) {
  sample_.Damage("zero");
  ASSERT_THAT(WriteFile(sample_.PathOf("unknown"), "unknown"), IsOk());
  const auto before = Check().problems;
  EXPECT_EQ(Check().problems.size(), before.size());
  EXPECT_TRUE(std::filesystem::exists(sample_.PathOf("unknown")));
}

TEST_F(StoreCheckTest, SaysThatTheSidesDoNotFit) {
  ASSERT_THAT(WriteFile(sample_.data_dir() + "/blobs/STORE", std::string(32, 'a') + "\n"), IsOk());
  EXPECT_THAT(Check().problems,
              ElementsAre(AllOf(Field(&StoreProblem::kind, Kind::kIdentity),
                                Field(&StoreProblem::text, HasSubstr("does not fit together")))));
}

TEST_F(StoreCheckTest, ListsTheQuarantine) {
  ASSERT_THAT(WriteFile(sample_.PathOf("unknown"), "unknown"), IsOk());
  sample_.Open();
  const StoreCheck check = Check();
  EXPECT_THAT(check.problems, IsEmpty());
  ASSERT_EQ(check.quarantine.size(), 1u);
  EXPECT_EQ(check.quarantine[0].name, IdOf("unknown"));
}

TEST_F(StoreCheckTest, WhatIsNoDataFolderIsSaidAndNotMade) {
  EXPECT_THAT(CheckStore(sample_.File("missing"), true),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("catalogue.db")));
  EXPECT_FALSE(std::filesystem::exists(sample_.File("missing")));
  EXPECT_THAT(CheckStore(sample_.data_dir(), true, Progress({}, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, _));
  ASSERT_THAT(WriteFile(sample_.data_dir() + "/catalogue.db", std::string(8192, 'x')), IsOk());
  EXPECT_THAT(CheckStore(sample_.data_dir(), true), HasStatus(absl::StatusCode::kDataLoss, _));
}

TEST(StoreProblemTest, EveryKindHasAName) {
  for (const Kind kind : {Kind::kIdentity, Kind::kBadRow, Kind::kMissingFile, Kind::kDamagedFile,
                          Kind::kUnreadableFile, Kind::kUnknownFile}) {
    EXPECT_STRNE(StoreProblemName(kind), "unknown");
  }
}

}  // namespace
}  // namespace pleat
