// Pages of the catalog: what is in them, and what they cost.
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

std::vector<std::string> IdsOf(const std::vector<CatalogEntry>& entries) {
  std::vector<std::string> ids;
  for (const CatalogEntry& entry : entries) ids.push_back(entry.id);
  return ids;
}

TEST(CatalogPage, PagesFollowEachOtherInTheOrderOfTheEntries) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  for (const char* id : {"c", "a", "e", "b", "d"}) {
    ASSERT_THAT(catalog->Put(EntryKind::kJob, {id, "record of " + std::string(id), 2}), IsOk());
    ASSERT_THAT(catalog->Put(EntryKind::kModel, {id, ""}), IsOk());
  }
  ASSERT_THAT(catalog->Put(EntryKind::kJob, {"a", "changed", 3}), IsOk());  // keeps its place
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto first, catalog->ListPage(EntryKind::kJob, 0, 2));
  ASSERT_THAT(IdsOf(first), ElementsAre("c", "a"));
  EXPECT_EQ(first[0].record, "record of c");
  EXPECT_EQ(first[1].record, "changed");
  EXPECT_EQ(first[1].attempts, 3);
  EXPECT_EQ(catalog->Get(EntryKind::kJob, "a")->position, first[1].position);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto second,
                             catalog->ListPage(EntryKind::kJob, first[1].position, 2));
  EXPECT_THAT(IdsOf(second), ElementsAre("e", "b"));
  // The place stays when the entry there goes, and new entries come behind all others.
  ASSERT_THAT(catalog->Delete(EntryKind::kJob, "b"), IsOk());
  ASSERT_THAT(catalog->Put(EntryKind::kJob, {"b", "again"}), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto third,
                             catalog->ListPage(EntryKind::kJob, second[1].position, 9));
  EXPECT_THAT(IdsOf(third), ElementsAre("d", "b"));
  EXPECT_TRUE(catalog->ListPage(EntryKind::kJob, third[1].position, 9)->empty());
  EXPECT_TRUE(catalog->ListPage(EntryKind::kRig, 0, 9)->empty());
}

// What a page costs is counted in the steps of SQLite's machine, so that no clock decides.
TEST(CatalogPage, APageCostsTheSameWhereverItIsAndWhateverElseIsThere) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  const auto steps_of = [&](EntryKind kind, int64_t after, size_t num_expected) {
    const uint64_t before = catalog->num_read_steps();
    EXPECT_EQ(catalog->ListPage(kind, after, 10)->size(), num_expected);
    return catalog->num_read_steps() - before;
  };
  for (int i = 0; i < 10; ++i) {
    ASSERT_THAT(catalog->Put(EntryKind::kModel, {"m" + std::to_string(i), ""}), IsOk());
    ASSERT_THAT(catalog->Put(EntryKind::kJob, {"j" + std::to_string(i), ""}), IsOk());
  }
  const uint64_t steps = steps_of(EntryKind::kJob, 0, 10);
  EXPECT_LT(steps, 300u);  // a few for each of ten rows
  for (int i = 10; i < 1000; ++i) {
    ASSERT_THAT(catalog->Put(EntryKind::kJob, {"j" + std::to_string(i), ""}), IsOk());
  }
  EXPECT_EQ(steps_of(EntryKind::kJob, 0, 10), steps);
  const int64_t middle = catalog->Get(EntryKind::kJob, "j500")->position;
  EXPECT_EQ(steps_of(EntryKind::kJob, middle, 10), steps);
  const int64_t end = catalog->Get(EntryKind::kJob, "j989")->position;
  EXPECT_EQ(steps_of(EntryKind::kJob, end, 10), steps);
  // A kind with few entries does not pay for one with many: without an index of the kinds the last
  // of these reads every job.
  EXPECT_EQ(steps_of(EntryKind::kModel, 0, 10), steps);
  EXPECT_LT(steps_of(EntryKind::kModel, catalog->Get(EntryKind::kModel, "m9")->position, 0), steps);
}

}  // namespace
}  // namespace pleat
