// What projects see of each other in the catalog: nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/store/project_catalog.h"
#include "sample_store.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr EntryKind kSequences = EntryKind::kSequence;

class CatalogProjectTest : public testing::Test {
 protected:
  static std::vector<std::string> RecordsOf(ProjectCatalog& catalog) {
    std::vector<std::string> records;
    const auto entries = catalog.ListPage(kSequences, 0, 100);
    for (const CatalogEntry& entry : *entries) records.push_back(entry.record);
    return records;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Catalog> catalog_ = Catalog::Open(folder_.File("c.db")).value();
  ProjectCatalog robots_{catalog_.get(), "robots"}, ghosts_{catalog_.get(), "ghosts"};
};

TEST_F(CatalogProjectTest, TheSameContentIsAnEntryOfEachProject) {
  ASSERT_THAT(robots_.Put(kSequences, {"a", "of robots", 0, 100, 500}), IsOk());
  const absl::Status none = ghosts_.Get(kSequences, "a").status();
  EXPECT_THAT(none, HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_EQ(none, catalog_->Get(kSequences, "a").status());
  ASSERT_THAT(ghosts_.Put(kSequences, {"a", "of ghosts", 0, 200, 600}), IsOk());
  EXPECT_EQ(robots_.Get(kSequences, "a")->record, "of robots");
  EXPECT_EQ(robots_.Get(kSequences, "a")->expires_unix_ms, 500);
  EXPECT_EQ(ghosts_.Get(kSequences, "a")->created_unix_ms, 200);
  EXPECT_EQ(ghosts_.Get(kSequences, "a")->project, "ghosts");
  EXPECT_EQ(catalog_->GetInAnyProject(kSequences, "a")->record, "of robots");  // the oldest
}

TEST_F(CatalogProjectTest, NoChangeReachesAnotherProject) {
  ASSERT_THAT(robots_.Put(kSequences, {"a", "r", 0, 100, 500}), IsOk());
  const std::string words = "no sequence 'a'";
  EXPECT_THAT(ghosts_.Delete(kSequences, "a"), HasStatus(absl::StatusCode::kNotFound, words));
  EXPECT_THAT(ghosts_.SetPinned(kSequences, "a", true),
              HasStatus(absl::StatusCode::kNotFound, words));
  EXPECT_THAT(ghosts_.Prolong(kSequences, "a", 0), HasStatus(absl::StatusCode::kNotFound, words));
  EXPECT_THAT(catalog_->DeleteExpired({kSequences, "ghosts"}, "a", 900),
              HasStatus(absl::StatusCode::kNotFound, words));
  EXPECT_EQ(robots_.Get(kSequences, "a")->expires_unix_ms, 500);
  EXPECT_FALSE(robots_.Get(kSequences, "a")->pinned);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto expired, catalog_->ListExpired(kSequences, 900));
  ASSERT_EQ(expired.size(), 1u);
  EXPECT_EQ(expired[0].project, "robots");
}

TEST_F(CatalogProjectTest, AListHoldsThoseOfItsProject) {
  for (const char* id : {"a", "b", "c"}) {
    ASSERT_THAT(robots_.Put(kSequences, {id, std::string("r") + id}), IsOk());
    ASSERT_THAT(ghosts_.Put(kSequences, {id, std::string("g") + id}), IsOk());
  }
  ASSERT_THAT(ghosts_.Delete(kSequences, "b"), IsOk());
  EXPECT_THAT(RecordsOf(robots_), ElementsAre("ra", "rb", "rc"));
  EXPECT_THAT(RecordsOf(ghosts_), ElementsAre("ga", "gc"));
  EXPECT_EQ(catalog_->List(kSequences)->size(), 5u);                      // for the operator
  EXPECT_THAT(catalog_->ListPage(kSequences, 0, 10).value(), IsEmpty());  // the default project
}

TEST_F(CatalogProjectTest, FilesAreCountedOnceForEachOfTheirProjects) {
  const auto put = [](ProjectCatalog& catalog, EntryKind kind, const std::string& id,
                      uint64_t bytes) {
    CatalogEntry entry{.id = id, .record = "r"};
    entry.file_bytes = bytes;
    ASSERT_THAT(catalog.Put(kind, entry), IsOk());
  };
  EXPECT_EQ(robots_.FileBytes().value(), 0u);
  put(robots_, kSequences, "a", 100);
  put(robots_, EntryKind::kModel, "b", 30);
  put(robots_, EntryKind::kJob, "job-1", 0);
  put(ghosts_, kSequences, "a", 100);
  EXPECT_EQ(robots_.FileBytes().value(), 130u);
  put(robots_, EntryKind::kModel, "b", 40);  // again, with another size
  EXPECT_EQ(robots_.FileBytes().value(), 140u);
  ASSERT_THAT(robots_.Delete(kSequences, "a"), IsOk());
  EXPECT_EQ(robots_.FileBytes().value(), 40u);
  EXPECT_EQ(ghosts_.FileBytes().value(), 100u);
  EXPECT_TRUE(catalog_->NamesFile("a").value());
  ASSERT_THAT(catalog_->DeleteInAllProjects("a"), IsOk());
  EXPECT_EQ(ghosts_.FileBytes().value(), 0u);
  EXPECT_FALSE(catalog_->NamesFile("a").value());
}

TEST_F(CatalogProjectTest, ThePageKeyOfACatalogStays) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string secret, catalog_->Secret());
  EXPECT_EQ(secret.size(), 64u);
  catalog_.reset();
  catalog_ = Catalog::Open(folder_.File("c.db")).value();
  EXPECT_EQ(catalog_->Secret().value(), secret);
  EXPECT_NE(Catalog::Open(folder_.File("d.db")).value()->Secret().value(), secret);
}

// Version 3 knew no projects and no sizes.
TEST(CatalogOfVersion3Test, ItsEntriesBecomeThoseOfTheDefaultProject) {
  TemporaryFolder folder;
  const std::string path = folder.File("catalogue.db");
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string golden,
                             ReadFile(InSourceFolder("tests/golden/records/catalog_v3.db")));
  ASSERT_THAT(WriteFile(path, golden), IsOk());
  const std::string model(64, 'e');
  CatalogEntry before;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::OpenReadOnly(path));
    PLEAT_ASSERT_OK_AND_ASSIGN(before, catalog->Get(EntryKind::kModel, model));
    EXPECT_EQ(catalog->ListPage(EntryKind::kJob, 0, 10)->size(), 2u);
    EXPECT_FALSE(catalog->Get({EntryKind::kModel, "robots"}, model).ok());
  }
  for (int start = 0; start < 2; ++start) {  // the second finds the new version
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(path));
    EXPECT_EQ(catalog->StoreId().value(), "0123456789abcdef0123456789abcdef");
    EXPECT_EQ(catalog->PendingRemovals()->size(), 1u);
    PLEAT_ASSERT_OK_AND_ASSIGN(const CatalogEntry after, catalog->Get(EntryKind::kModel, model));
    EXPECT_EQ(after.record, before.record);
    EXPECT_EQ(after.position, before.position);
    EXPECT_EQ(after.created_unix_ms, 1'790'000'000'000);
    EXPECT_EQ(after.expires_unix_ms, 1'800'000'000'000);
    EXPECT_TRUE(after.pinned);
    EXPECT_EQ(after.project, kDefaultProject);
    EXPECT_EQ(catalog->ListPage(EntryKind::kJob, 0, 10)->size(), 2u);
    if (start == 0) {
      EXPECT_THAT(catalog->FilesWithoutSize().value(), testing::Contains(model));
      ASSERT_THAT(catalog->NoteFileSize(model, 77), IsOk());
    }
    EXPECT_EQ(catalog->ProjectBytes(kDefaultProject).value(), 77u);
  }
  // New entries come behind all that there ever were, those that were deleted included.
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(path));
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"new", "r"}), IsOk());
  EXPECT_GT(catalog->Get(EntryKind::kModel, "new")->position, before.position + 1);
}

// Content of two projects is one file, which goes with the last of them.
TEST(StoreOfProjectsTest, AFileStaysAsLongAsAnyProjectHasIt) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto store,
                             Store::Open({.data_dir = folder.path(), .reserve_bytes = 0}));
  const std::string id = IdOf("content");
  for (const char* project : {"robots", "ghosts"}) {
    CatalogEntry entry{.id = id, .record = SampleStore::RecordOf("content")};
    entry.project = project;
    ASSERT_THAT(store->Add(kSequences, entry, "content"), IsOk());
    EXPECT_EQ(store->catalog().ProjectBytes(project).value(), 7u);
  }
  EXPECT_THAT(store->Delete(kSequences, id), HasStatus(absl::StatusCode::kNotFound, _));
  ASSERT_THAT(store->Delete({kSequences, "robots"}, id), IsOk());
  EXPECT_EQ(store->Read(id).value(), "content");
  store.reset();
  PLEAT_ASSERT_OK_AND_ASSIGN(store, Store::Open({.data_dir = folder.path(), .reserve_bytes = 0}));
  EXPECT_EQ(store->Read(id).value(), "content");
  ASSERT_THAT(store->Delete({kSequences, "ghosts"}, id), IsOk());
  EXPECT_FALSE(store->blobs().Contains(id));
}

TEST(StoreOfProjectsTest, WhatArrivesForOneProjectIsNothingToAnother) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto store,
                             Store::Open({.data_dir = folder.path(), .reserve_bytes = 0}));
  PLEAT_ASSERT_OK_AND_ASSIGN(UploadArea* const robots, store->uploads("robots"));
  PLEAT_ASSERT_OK_AND_ASSIGN(UploadArea* const ghosts, store->uploads("ghosts"));
  const std::string id = IdOf("content");
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto first, robots->Begin(id, 7, 0));
  ASSERT_THAT(first->Append("cont"), IsOk());
  EXPECT_EQ(robots->TotalBytes(), 4u);
  EXPECT_EQ(ghosts->ReceivedBytes(id), 0u);
  EXPECT_EQ(store->uploads().ReceivedBytes(id), 0u);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto second, ghosts->Begin(id, 7, 0));  // both write
  EXPECT_THAT(store->UploadProjects(),
              testing::UnorderedElementsAre(kDefaultProject, "robots", "ghosts"));
  EXPECT_THAT(store->uploads("../.."), HasStatus(kInvalid, _));
}

}  // namespace
}  // namespace pleat
