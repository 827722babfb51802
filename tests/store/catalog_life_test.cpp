// How long entries live: times to live, pins, and what retention deletes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pleat/store/catalog.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr EntryKind kKind = EntryKind::kSequence;

class CatalogLifeTest : public testing::Test {
 protected:
  absl::Status Put(const std::string& id, int64_t created, int64_t expires) {
    return catalog_->Put(
        kKind, {.id = id, .record = "r", .created_unix_ms = created, .expires_unix_ms = expires});
  }
  int64_t ExpiryOf(const std::string& id) { return catalog_->Get(kKind, id)->expires_unix_ms; }
  std::vector<std::string> ExpiredAt(int64_t now) {
    std::vector<std::string> ids;
    const auto entries = catalog_->ListExpired(kKind, now);
    for (const CatalogEntry& entry : *entries) ids.push_back(entry.id);
    return ids;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Catalog> catalog_ = Catalog::Open(folder_.File("c.db")).value();
};

TEST_F(CatalogLifeTest, AnEntryKeepsItsCreationAndTheLongestLife) {
  ASSERT_THAT(Put("a", 100, 500), IsOk());
  ASSERT_THAT(Put("a", 200, 400), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const CatalogEntry entry, catalog_->Get(kKind, "a"));
  EXPECT_EQ(entry.created_unix_ms, 100);
  EXPECT_EQ(entry.expires_unix_ms, 500);
  ASSERT_THAT(Put("a", 200, 600), IsOk());
  EXPECT_EQ(ExpiryOf("a"), 600);
  ASSERT_THAT(Put("a", 200, 0), IsOk());  // for ever
  EXPECT_EQ(ExpiryOf("a"), 0);
  ASSERT_THAT(Put("a", 200, 700), IsOk());
  EXPECT_EQ(ExpiryOf("a"), 0);
}

TEST_F(CatalogLifeTest, ALifeIsProlongedAndNeverCutShort) {
  ASSERT_THAT(Put("a", 100, 500), IsOk());
  for (const auto& [asked, expected] :
       {std::pair(400, 500), std::pair(600, 600), std::pair(0, 0), std::pair(700, 0)}) {
    ASSERT_THAT(catalog_->Prolong(kKind, "a", asked), IsOk());
    EXPECT_EQ(ExpiryOf("a"), expected);
  }
  EXPECT_THAT(catalog_->Prolong(kKind, "b", 1),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no sequence 'b'")));
}

TEST_F(CatalogLifeTest, OnlyWhatHasExpiredAndIsNotPinnedIsDeleted) {
  ASSERT_THAT(Put("for ever", 1, 0), IsOk());
  ASSERT_THAT(Put("late", 1, 300), IsOk());
  ASSERT_THAT(Put("pinned", 1, 100), IsOk());
  ASSERT_THAT(Put("early", 1, 100), IsOk());
  ASSERT_THAT(catalog_->Put(EntryKind::kModel, {.id = "early", .expires_unix_ms = 1}), IsOk());
  ASSERT_THAT(catalog_->SetPinned(kKind, "pinned", true), IsOk());
  EXPECT_TRUE(catalog_->Get(kKind, "pinned")->pinned);
  EXPECT_THAT(ExpiredAt(99), IsEmpty());
  EXPECT_THAT(ExpiredAt(100), ElementsAre("early"));
  EXPECT_THAT(ExpiredAt(300), ElementsAre("late", "early"));
  for (const char* id : {"for ever", "late", "pinned", "none"}) {
    EXPECT_THAT(catalog_->DeleteExpired(kKind, id, 100),
                HasStatus(absl::StatusCode::kNotFound, testing::_));
  }
  ASSERT_THAT(catalog_->DeleteExpired(kKind, "early", 100), IsOk());
  EXPECT_THAT(ExpiredAt(100), IsEmpty());
  EXPECT_THAT(catalog_->Get(EntryKind::kModel, "early"), IsOk());
  EXPECT_EQ(catalog_->List(kKind)->size(), 3u);
}

TEST_F(CatalogLifeTest, APinOutlivesARestartAndANewRecord) {
  ASSERT_THAT(Put("a", 100, 500), IsOk());
  ASSERT_THAT(catalog_->SetPinned(kKind, "a", true), IsOk());
  ASSERT_THAT(Put("a", 100, 500), IsOk());
  catalog_.reset();
  catalog_ = Catalog::Open(folder_.File("c.db")).value();
  EXPECT_TRUE(catalog_->Get(kKind, "a")->pinned);
  EXPECT_TRUE(catalog_->ListPage(kKind, 0, 1)->at(0).pinned);
  ASSERT_THAT(catalog_->SetPinned(kKind, "a", false), IsOk());
  EXPECT_FALSE(catalog_->Get(kKind, "a")->pinned);
  EXPECT_THAT(catalog_->SetPinned(kKind, "b", true),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_F(CatalogLifeTest, ADeletedEntryIsBornAgainWithoutItsPast) {
  ASSERT_THAT(Put("a", 100, 0), IsOk());
  ASSERT_THAT(catalog_->SetPinned(kKind, "a", true), IsOk());
  ASSERT_THAT(catalog_->Delete(kKind, "a"), IsOk());
  ASSERT_THAT(Put("a", 200, 300), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const CatalogEntry entry, catalog_->Get(kKind, "a"));
  EXPECT_EQ(entry.created_unix_ms, 200);
  EXPECT_EQ(entry.expires_unix_ms, 300);
  EXPECT_FALSE(entry.pinned);
}

}  // namespace
}  // namespace pleat
