// What a start does with what it finds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/store/store.h"
#include "store/sample_store.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Opens a store and collects what it tells the operator.
class ReportingStore {
 public:
  explicit ReportingStore(const std::string& data_dir)
      : store_(Store::Open({.data_dir = data_dir, .on_problem = [this](const std::string& problem) {
                              problems_.push_back(problem);
                            }})) {}
  const absl::Status& status() const { return store_.status(); }
  Store* operator->() { return store_->get(); }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
  absl::StatusOr<std::unique_ptr<Store>> store_;
};

// A store with three models; returns the folder's catalog before the third.
std::string MakeStoreOfThree(const std::string& data_dir) {
  std::string before;
  for (const char* bytes : {"one", "two", "three"}) {
    if (bytes == std::string("three")) before = ReadFile(data_dir + "/catalogue.db").value();
    auto store = Store::Open({.data_dir = data_dir}).value();
    EXPECT_THAT(store->Add(EntryKind::kModel, {IdOf(bytes), "record"}, bytes), IsOk());
  }
  return before;
}

size_t NumFiles(const std::string& folder) {
  size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    count += entry.path().filename().string().size() == 64;
  }
  return count;
}

TEST(StoreStartTest, MovesFilesWithoutRowToQuarantineAndReportsRowsWithoutFile) {
  TemporaryFolder folder;
  std::string kept, orphan, lost;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.path()}));
    kept = store->blobs().Put("kept").value();
    orphan = store->blobs().Put("orphan").value();
    lost = store->blobs().Put("lost").value();
    ASSERT_THAT(store->catalog().Put(EntryKind::kModel, {kept, "", 0}), IsOk());
    ASSERT_THAT(store->catalog().Put(EntryKind::kSequence, {lost, "", 0}), IsOk());
    ASSERT_THAT(store->blobs().Delete(lost), IsOk());
  }
  ReportingStore store(folder.path());
  ASSERT_THAT(store.status(), IsOk());
  EXPECT_TRUE(store->blobs().Contains(kept));
  EXPECT_FALSE(store->blobs().Contains(orphan));
  EXPECT_EQ(ReadFile(folder.File("quarantine/" + orphan)).value(), "orphan");
  EXPECT_EQ(store->quarantine().List()->at(0).reason, "no entry names it");
  EXPECT_THAT(store->missing_files(), ElementsAre(lost));
  EXPECT_THAT(store.problems(),
              ElementsAre(HasSubstr(lost), HasSubstr("files that no entry names: 1 moved")));
}

// What erased 3 to 8 files of 0.1.0 without a word.
TEST(StoreStartTest, ALostCatalogErasesNothing) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  const std::function<void()> losses[] = {
      [&] { std::filesystem::remove(folder.File("catalogue.db")); },
      [&] { EXPECT_THAT(WriteFile(folder.File("catalogue.db"), ""), IsOk()); },
      [&] {  // the catalog of another store
        TemporaryFolder other;
        MakeStoreOfThree(other.path());
        std::filesystem::copy_file(other.File("catalogue.db"), folder.File("catalogue.db"),
                                   std::filesystem::copy_options::overwrite_existing);
      }};
  for (const auto& lose : losses) {
    lose();
    for (int start = 0; start < 2; ++start) {
      EXPECT_THAT(Store::Open({.data_dir = folder.path()}),
                  HasStatus(absl::StatusCode::kFailedPrecondition,
                            testing::AllOf(HasSubstr("does not fit together"),
                                           HasSubstr("pleat store repair"))));
      EXPECT_EQ(NumFiles(folder.File("blobs")), 3u);
    }
  }
}

TEST(StoreStartTest, ABitFlippedInTheCatalogErasesNothing) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  const std::string intact = ReadFile(folder.File("catalogue.db")).value();
  for (size_t offset = 3; offset < intact.size(); offset += intact.size() / 61) {
    std::string flipped = intact;
    flipped[offset] ^= 0x10;
    ASSERT_THAT(WriteFile(folder.File("catalogue.db"), flipped), IsOk());
    { const auto store = Store::Open({.data_dir = folder.path()}); }
    EXPECT_EQ(NumFiles(folder.path()), 3u) << "offset " << offset;
  }
}

TEST(StoreStartTest, TheCatalogOfYesterdayQuarantinesWhatItDoesNotKnow) {
  TemporaryFolder folder;
  const std::string yesterday = MakeStoreOfThree(folder.path());
  ASSERT_THAT(WriteFile(folder.File("catalogue.db"), yesterday), IsOk());
  ReportingStore store(folder.path());
  ASSERT_THAT(store.status(), IsOk());
  EXPECT_EQ(store->blobs().List()->size(), 2u);
  EXPECT_EQ(ReadFile(folder.File("quarantine/" + IdOf("three"))).value(), "three");
  EXPECT_THAT(store.problems(), ElementsAre(HasSubstr("moved to the quarantine")));
  // The same content again is stored again.
  EXPECT_THAT(store->Add(EntryKind::kModel, {IdOf("three"), "record"}, "three"), IsOk());
  EXPECT_EQ(store->Read(IdOf("three")).value(), "three");
}

TEST(StoreStartTest, FilesThatAreNotMountedAreNotedAsLost) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  std::filesystem::rename(folder.File("blobs"), folder.File("elsewhere"));
  EXPECT_THAT(
      Store::Open({.data_dir = folder.path()}),
      HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("is a disk not mounted?")));
  std::filesystem::remove_all(folder.File("blobs"));
  std::filesystem::rename(folder.File("elsewhere"), folder.File("blobs"));
  ReportingStore store(folder.path());
  ASSERT_THAT(store.status(), IsOk());
  EXPECT_TRUE(store.problems().empty());
}

// Deleted means deleted, also when the server dies between the row and the file.
TEST(StoreStartTest, AStartEndsADeletion) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("catalogue.db")));
    ASSERT_THAT(catalog->Delete(EntryKind::kModel, IdOf("two")), IsOk());
  }
  ReportingStore store(folder.path());
  ASSERT_THAT(store.status(), IsOk());
  EXPECT_TRUE(store.problems().empty());
  EXPECT_EQ(NumFiles(folder.path()), 2u);
  EXPECT_TRUE(store->catalog().PendingRemovals()->empty());
}

TEST(StoreStartTest, ADamagedFileIsNeverServedAndCanBeUploadedAgain) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  ReportingStore store(folder.path());
  const std::string id = IdOf("one");
  ASSERT_THAT(WriteFile(store->blobs().PathOf(id), "0ne"), IsOk());
  EXPECT_THAT(store->Read(id),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("upload it again")));
  EXPECT_THAT(store->Read(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_EQ(ReadFile(folder.File("quarantine/" + id)).value(), "0ne");
  EXPECT_THAT(store.problems(), ElementsAre(HasSubstr(id)));
  EXPECT_THAT(store->Add(EntryKind::kModel, {id, "record"}, "one"), IsOk());
  EXPECT_EQ(store->Read(id).value(), "one");
  EXPECT_THAT(store->Verify(id), IsOk());
}

TEST(StoreStartTest, AFileThatAnotherKindNamesStays) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto store, Store::Open({.data_dir = folder.path()}));
  ASSERT_THAT(store->Add(EntryKind::kModel, {IdOf("both"), ""}, "both"), IsOk());
  ASSERT_THAT(store->Add(EntryKind::kRig, {IdOf("both"), ""}, "both"), IsOk());
  ASSERT_THAT(store->Delete(EntryKind::kRig, IdOf("both")), IsOk());
  EXPECT_EQ(store->Read(IdOf("both")).value(), "both");
  ASSERT_THAT(store->Delete(EntryKind::kModel, IdOf("both")), IsOk());
  EXPECT_FALSE(store->blobs().Contains(IdOf("both")));
  EXPECT_TRUE(store->catalog().PendingRemovals()->empty());
}

// The first version had neither a store id nor pending removals.
TEST(StoreStartTest, AStoreOfTheFirstVersionGetsAnId) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string golden,
                             ReadFile(InSourceFolder("tests/golden/records/catalogue.db")));
  ASSERT_THAT(WriteFile(folder.File("catalogue.db"), golden), IsOk());
  { ASSERT_TRUE(Catalog::OpenReadOnly(folder.File("catalogue.db")).ok()); }
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("catalogue.db")));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto ids, catalog->FileIds());
    for (const std::string& named : ids) {
      ASSERT_THAT(WriteFile(folder.File("blobs/" + named.substr(0, 2) + "/" + named), "x"), IsOk());
    }
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto store, Store::Open({.data_dir = folder.path()}));
  EXPECT_EQ(store->catalog().StoreId()->size(), 32u);
  EXPECT_EQ(ReadFile(folder.File("blobs/STORE")).value(),
            store->catalog().StoreId().value() + "\n");
}

// The second version had no index for pages and knew no times.
TEST(StoreStartTest, AStoreOfTheSecondVersionIsReadAndUpgraded) {
  TemporaryFolder folder;
  const std::string path = folder.File("catalogue.db");
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string golden,
                             ReadFile(InSourceFolder("tests/golden/records/catalog_v2.db")));
  ASSERT_THAT(WriteFile(path, golden), IsOk());
  std::vector<CatalogEntry> before;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::OpenReadOnly(path));
    PLEAT_ASSERT_OK_AND_ASSIGN(before, catalog->List(EntryKind::kJob));
    EXPECT_EQ(catalog->StoreId().value(), "0123456789abcdef0123456789abcdef");
  }
  for (int start = 0; start < 2; ++start) {  // the second finds the new version
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(path));
    EXPECT_EQ(catalog->StoreId().value(), "0123456789abcdef0123456789abcdef");
    EXPECT_EQ(catalog->PendingRemovals()->size(), 1u);
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto after, catalog->ListPage(EntryKind::kJob, 0, 10));
    ASSERT_EQ(after.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(after[i].id, before[i].id);
      EXPECT_EQ(after[i].record, before[i].record);
      EXPECT_EQ(after[i].attempts, before[i].attempts);
      EXPECT_EQ(after[i].position, before[i].position);
      EXPECT_EQ(after[i].created_unix_ms, 0);
      EXPECT_EQ(after[i].expires_unix_ms, 0);
      EXPECT_FALSE(after[i].pinned);
    }
    EXPECT_EQ(catalog->ListPage(EntryKind::kModel, 0, 10)->size(), 1u);
  }
}

TEST(StoreStartTest, AFullDiskRefusesUploadsAndNothingElse) {
  TemporaryFolder folder;
  MakeStoreOfThree(folder.path());
  std::vector<std::string> problems;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto store,
      Store::Open({.data_dir = folder.path(),
                   .reserve_bytes = uint64_t{1} << 60,
                   .on_problem = [&](const std::string& text) { problems.push_back(text); }}));
  EXPECT_THAT(problems, ElementsAre(HasSubstr("no room")));
  EXPECT_THAT(store->Add(EntryKind::kModel, {IdOf("four"), ""}, "four"),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("room")));
  EXPECT_EQ(store->Read(IdOf("one")).value(), "one");
  EXPECT_THAT(store->Delete(EntryKind::kModel, IdOf("one")), IsOk());
}

}  // namespace
}  // namespace pleat
