#include "pleat/store/store_backup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "absl/strings/str_cat.h"
#include "store/sample_store.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class StoreBackupTest : public testing::Test {
 protected:
  StoreCopy Backup() {
    absl::StatusOr<StoreCopy> copy = BackupStore(sample_.data_dir(), backup_);
    EXPECT_THAT(copy, IsOk());
    return copy.value_or(StoreCopy());
  }
  void ExpectSound(const std::string& folder, size_t num_files) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const StoreCheck check, CheckStore(folder, true));
    EXPECT_THAT(check.problems, IsEmpty());
    EXPECT_EQ(check.num_files, num_files);
  }

  SampleStore sample_;
  const std::string backup_ = sample_.File("backup");
};

TEST_F(StoreBackupTest, ARestoredStoreIsTheOneThatWasBackedUp) {
  const StoreCopy copy = Backup();
  EXPECT_EQ(copy.num_copied, 3u);
  EXPECT_EQ(copy.bytes_copied, 10u);
  ExpectSound(backup_, 3);
  std::filesystem::rename(sample_.data_dir(), sample_.File("lost"));
  EXPECT_THAT(RestoreStore(backup_, sample_.data_dir()), IsOk());
  ExpectSound(sample_.data_dir(), 3);
  const auto store = sample_.Open();
  EXPECT_EQ(store->Read(IdOf("two")).value(), "two");
  EXPECT_EQ(store->catalog().List(EntryKind::kJob)->size(), 1u);
  EXPECT_THAT(store->missing_files(), IsEmpty());
}

TEST_F(StoreBackupTest, ARenewalCopiesWhatIsNewAndDropsWhatIsGone) {
  Backup();
  {
    const auto store = sample_.Open();
    SampleStore::Add(store.get(), "three");
    ASSERT_THAT(store->Delete(EntryKind::kSequence, IdOf("one")), IsOk());
    const StoreCopy copy = Backup();  // while the store is open
    EXPECT_EQ(copy.num_copied, 1u);
    EXPECT_EQ(copy.num_kept, 2u);
    EXPECT_EQ(copy.num_removed, 1u);
  }
  ExpectSound(backup_, 3);
}

// Whatever moment the backup catches, each of its entries has its file.
TEST_F(StoreBackupTest, IsConsistentWhileAServerAddsAndDeletes) {
  const auto store = sample_.Open();
  std::atomic<bool> done = false;
  std::thread server([&] {
    for (int i = 0; !done; ++i) {
      SampleStore::Add(store.get(), absl::StrCat("new ", i));
      if (i >= 2) {
        EXPECT_THAT(store->Delete(EntryKind::kSequence, IdOf(absl::StrCat("new ", i - 2))), IsOk());
      }
    }
  });
  for (int round = 0; round < 8; ++round) {
    EXPECT_THAT(Backup().problems, IsEmpty());
    PLEAT_ASSERT_OK_AND_ASSIGN(const StoreCheck check, CheckStore(backup_, true));
    EXPECT_THAT(check.problems, IsEmpty());
    EXPECT_GE(check.num_files, 3u);
  }
  done = true;
  server.join();
}

TEST_F(StoreBackupTest, DamageIsNamedAndNotCopied) {
  sample_.Damage("zero");
  sample_.Remove("one");
  const StoreCopy copy = Backup();
  EXPECT_EQ(copy.num_copied, 1u);
  ASSERT_EQ(copy.problems.size(), 2u);
  for (const StoreProblem& problem : copy.problems) {
    EXPECT_EQ(problem.kind, problem.id == IdOf("zero") ? StoreProblem::Kind::kDamagedFile
                                                       : StoreProblem::Kind::kMissingFile);
  }
  // The copy of an earlier, sound backup is not replaced by a damaged file.
  EXPECT_FALSE(std::filesystem::exists(backup_ + "/blobs/" + IdOf("zero").substr(0, 2) + "/" +
                                       IdOf("zero")));
}

TEST_F(StoreBackupTest, GoesNowhereElse) {
  ASSERT_THAT(WriteFile(sample_.File("other/notes.txt"), "mine"), IsOk());
  EXPECT_THAT(BackupStore(sample_.data_dir(), sample_.File("other")),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("no backup")));
  const SampleStore another;
  ASSERT_THAT(BackupStore(another.data_dir(), sample_.File("another")), IsOk());
  EXPECT_THAT(BackupStore(sample_.data_dir(), sample_.File("another")),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("another store")));
  EXPECT_THAT(BackupStore(sample_.File("missing"), backup_),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("catalogue.db")));
  EXPECT_FALSE(std::filesystem::exists(backup_));
}

TEST_F(StoreBackupTest, ARestoreOverwritesNothing) {
  Backup();
  EXPECT_THAT(RestoreStore(backup_, sample_.data_dir()),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("not empty")));
  EXPECT_THAT(RestoreStore(sample_.File("missing"), sample_.File("new")),
              HasStatus(absl::StatusCode::kNotFound, _));
  const auto store = sample_.Open();
  EXPECT_THAT(BackupStore(backup_, sample_.data_dir()),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
}

TEST_F(StoreBackupTest, AnInterruptedRenewalLeavesTheBackupAsItWas) {
  Backup();
  {
    const auto store = sample_.Open();
    SampleStore::Add(store.get(), "three");
    SampleStore::Add(store.get(), "four");
  }
  int num_reports = 0;
  const Progress interrupted({}, [&] { return ++num_reports > 3; });
  EXPECT_THAT(BackupStore(sample_.data_dir(), backup_, interrupted),
              HasStatus(absl::StatusCode::kCancelled, _));
  PLEAT_ASSERT_OK_AND_ASSIGN(const StoreCheck check, CheckStore(backup_, true));
  EXPECT_EQ(check.num_entries[0], 3u);
  for (const StoreProblem& problem : check.problems) {
    EXPECT_EQ(problem.kind, StoreProblem::Kind::kUnknownFile);  // of the renewal
  }
  EXPECT_THAT(Backup().problems, IsEmpty());
  ExpectSound(backup_, 5);
}

}  // namespace
}  // namespace pleat
