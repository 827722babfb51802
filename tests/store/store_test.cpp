#include "pleat/store/store.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "store/sample_store.h"
#include "store/sync_gate.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(StoreTest, OneProcessPerFolder) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.File("data")}));
  EXPECT_THAT(Store::Open({.data_dir = folder.File("data")}),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  store.reset();
  EXPECT_THAT(Store::Open({.data_dir = folder.File("data")}), IsOk());
}

TEST(StoreTest, AProbeTellsWhetherSomethingCanBeStored) {
  TemporaryFolder folder;
  const std::string data = folder.File("data");
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto store,
                               Store::Open({.data_dir = data, .reserve_bytes = 0}));
    EXPECT_THAT(store->ProbeDisk(), IsOk());
    EXPECT_FALSE(std::filesystem::exists(data + "/probe"));
    // What is in the way of the probe is in the way of everything.
    std::filesystem::create_directories(data + "/probe/x");
    const absl::Status status = store->ProbeDisk();
    EXPECT_THAT(status, HasStatus(absl::StatusCode::kUnavailable, HasSubstr("written")));
    EXPECT_EQ(status.message().find(data), absl::string_view::npos) << "clients may see it";
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto full,
                             Store::Open({.data_dir = data, .reserve_bytes = uint64_t{1} << 60}));
  EXPECT_THAT(full->ProbeDisk(),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("no room")));
}

class StoreSyncTest : public testing::Test {
 protected:
  absl::Status AddModel(const std::string& bytes) {
    return store_->Add(EntryKind::kModel, {IdOf(bytes), "record"}, bytes);
  }

  TemporaryFolder folder_;
  SyncGate gate_;
  std::unique_ptr<Store> store_ =
      Store::Open({.data_dir = folder_.path(), .before_sync = gate_.hook()}).value();
};

TEST_F(StoreSyncTest, TheFileIsDurableBeforeItsRow) {
  const std::string id = IdOf("bytes");
  const std::string shard = folder_.File("blobs/" + id.substr(0, 2));
  gate_.TakePaths();
  ASSERT_THAT(AddModel("bytes"), IsOk());
  EXPECT_THAT(gate_.TakePaths(),
              ElementsAre(StartsWith(shard + "/" + id + ".tmp-"), shard, folder_.File("blobs"),
                          folder_.File("catalogue.db-wal")));
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, store_->uploads().Begin(IdOf("upload"), 6, 0));
  ASSERT_THAT(upload->Append("upload"), IsOk());
  ASSERT_THAT(upload->ReadComplete(), IsOk());
  ASSERT_THAT(store_->Add(EntryKind::kSequence, {upload->id(), "record"}, upload.get()), IsOk());
  EXPECT_THAT(gate_.TakePaths(),
              ElementsAre(folder_.File("uploads/" + upload->id() + ".part"),
                          folder_.File("blobs/" + upload->id().substr(0, 2)), folder_.File("blobs"),
                          folder_.File("catalogue.db-wal")));
  EXPECT_EQ(store_->blobs().Get(upload->id()).value(), "upload");
  EXPECT_THAT(store_->catalog().Get(EntryKind::kSequence, upload->id()), IsOk());
}

TEST_F(StoreSyncTest, NoReadWaitsForASync) {
  ASSERT_THAT(AddModel("old"), IsOk());
  int num_added = 0;
  for (const std::function<bool(const std::string&)>& slow :
       std::vector<std::function<bool(const std::string&)>>{
           PathContains(".tmp-"), PathEndsWith("/blobs"), PathEndsWith("/catalogue.db-wal")}) {
    const std::string added = absl::StrCat("new ", ++num_added);
    gate_.Close(slow);
    std::thread writer([&] { EXPECT_THAT(AddModel(added), IsOk()); });
    gate_.WaitForOneThatWaits();
    EXPECT_THAT(store_->catalog().Get(EntryKind::kModel, IdOf("old")), IsOk());
    EXPECT_THAT(store_->catalog().List(EntryKind::kModel), IsOk());
    EXPECT_EQ(store_->blobs().Get(IdOf("old")).value(), "old");
    EXPECT_EQ(store_->uploads().ReceivedBytes(IdOf("old")), 0u);
    EXPECT_THAT(store_->catalog().Get(EntryKind::kModel, IdOf(added)),
                HasStatus(absl::StatusCode::kNotFound, testing::_));
    gate_.Open();
    writer.join();
    EXPECT_THAT(store_->catalog().Get(EntryKind::kModel, IdOf(added)), IsOk());
  }
}

TEST_F(StoreSyncTest, NoChangeWaitsForTheContentOfAnother) {
  ASSERT_THAT(AddModel("old"), IsOk());
  gate_.Close(PathContains("/" + IdOf("large") + ".tmp-"));
  std::thread writer([&] { EXPECT_THAT(AddModel("large"), IsOk()); });
  gate_.WaitForOneThatWaits();
  EXPECT_THAT(AddModel("small"), IsOk());
  EXPECT_THAT(store_->Delete(EntryKind::kModel, IdOf("old")), IsOk());
  // Not even a change of the same id: the lock is not taken yet.
  EXPECT_THAT(store_->Delete(EntryKind::kModel, IdOf("large")),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  gate_.Open();
  writer.join();
  EXPECT_EQ(store_->blobs().Get(IdOf("large")).value(), "large");
}

// Add finds the content there, and then a Delete that was faster takes it away.
TEST_F(StoreSyncTest, AnAddedEntryHasItsFileWhateverADeleteDoes) {
  ASSERT_THAT(AddModel("bytes"), IsOk());
  gate_.Close(PathEndsWith("/catalogue.db-wal"));
  std::thread deleter(
      [&] { EXPECT_THAT(store_->Delete(EntryKind::kModel, IdOf("bytes")), IsOk()); });
  gate_.WaitForOneThatWaits();
  std::thread adder([&] { EXPECT_THAT(AddModel("bytes"), IsOk()); });
  gate_.Open();
  deleter.join();
  adder.join();
  EXPECT_THAT(store_->catalog().Get(EntryKind::kModel, IdOf("bytes")), IsOk());
  EXPECT_EQ(store_->blobs().Get(IdOf("bytes")).value(), "bytes");
}

TEST_F(StoreSyncTest, ARowAlwaysHasItsFile) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 10; ++round) {
        if ((i + round) % 2 == 0) {
          EXPECT_THAT(AddModel("bytes"), IsOk());
        } else {
          store_->Delete(EntryKind::kModel, IdOf("bytes")).IgnoreError();
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(store_->catalog().Get(EntryKind::kModel, IdOf("bytes")).ok(),
            store_->blobs().Contains(IdOf("bytes")));
}

TEST_F(StoreSyncTest, RefusesAnIdThatIsNotTheContents) {
  EXPECT_THAT(store_->Add(EntryKind::kModel, {IdOf("a"), ""}, "b"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("SHA-256")));
  EXPECT_THAT(store_->catalog().Get(EntryKind::kModel, IdOf("a")),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_TRUE(store_->blobs().List()->empty());
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, store_->uploads().Begin(IdOf("a"), 1, 0));
  EXPECT_THAT(store_->Add(EntryKind::kModel, {IdOf("b"), ""}, upload.get()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("upload")));
}

TEST(StoreTest, SaysWhyItCannotStart) {
  EXPECT_THAT(Store::Open({}), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  EXPECT_FALSE(Store::Open({.data_dir = "/proc/no-such-place"}).ok());
}

TEST_F(StoreSyncTest, AnEntryOfAnotherKindTakesNoFileAway) {
  ASSERT_THAT(AddModel("bytes"), IsOk());
  for (const EntryKind kind : {EntryKind::kSequence, EntryKind::kRig, EntryKind::kJob}) {
    EXPECT_THAT(store_->Delete(kind, IdOf("bytes")),
                HasStatus(absl::StatusCode::kNotFound, testing::_));
  }
  EXPECT_EQ(store_->blobs().Get(IdOf("bytes")).value(), "bytes");
}

TEST_F(StoreSyncTest, AddingAgainReplacesTheRecordAndKeepsThePlace) {
  ASSERT_THAT(AddModel("first"), IsOk());
  ASSERT_THAT(AddModel("second"), IsOk());
  ASSERT_THAT(store_->Add(EntryKind::kModel, {IdOf("first"), "a new record"}, "first"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto entries, store_->catalog().List(EntryKind::kModel));
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].record, "a new record");
  EXPECT_EQ(store_->blobs().List()->size(), 2u);
}

TEST(StoreTest, AStartKeepsWhatARowNamesAndUploadsAndNothingElse) {
  TemporaryFolder folder;
  const std::vector<EntryKind> kinds = {EntryKind::kSequence, EntryKind::kModel,
                                        EntryKind::kCompressedSequence, EntryKind::kRig};
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.path()}));
    for (size_t k = 0; k < kinds.size(); ++k) {
      const std::string bytes = absl::StrCat("kind ", k);
      ASSERT_THAT(store->Add(kinds[k], {IdOf(bytes), ""}, bytes), IsOk());
    }
    // The row of a job needs no file and keeps none.
    ASSERT_THAT(store->catalog().Put(EntryKind::kJob, {IdOf("job"), "", 0}), IsOk());
    ASSERT_THAT(store->blobs().Put("job"), IsOk());
    ASSERT_THAT((*store->uploads().Begin(IdOf("upload"), 6, 0))->Append("upl"), IsOk());
  }
  ASSERT_THAT(WriteFile(folder.File("blobs/ab/" + std::string(64, 'a') + ".tmp-abcdef"), "half"),
              IsOk());
  for (int start = 0; start < 2; ++start) {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.path()}));
    EXPECT_TRUE(store->missing_files().empty());
    EXPECT_EQ(store->blobs().List()->size(), kinds.size());
    for (size_t k = 0; k < kinds.size(); ++k) {
      EXPECT_THAT(store->blobs().Get(IdOf(absl::StrCat("kind ", k))), IsOk());
    }
    EXPECT_EQ(store->uploads().ReceivedBytes(IdOf("upload")), 3u);
  }
}

TEST(StoreTest, AFolderInUseNamesItsHolder) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto store, Store::Open({.data_dir = folder.path()}));
  EXPECT_THAT(Store::Open({.data_dir = folder.path()}),
              HasStatus(absl::StatusCode::kFailedPrecondition,
                        testing::AllOf(HasSubstr(absl::StrCat("(process ", getpid(), ")")),
                                       HasSubstr("--data-dir"))));
}

// A child adds and deletes as fast as it can and is killed; afterwards every row has its file.
TEST(StoreTest, AKillLeavesNoRowWithoutItsFile) {
  TemporaryFolder folder;
  for (int round = 0; round < 3; ++round) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      auto store = Store::Open({.data_dir = folder.path()});
      for (int i = 0; store.ok(); ++i) {
        const std::string bytes = absl::StrCat(i % 7), id = ToHex(ComputeSha256(bytes));
        if (!(*store)->Add(EntryKind::kModel, {id, bytes}, bytes).ok()) _exit(1);
        if (i % 2 == 1 && !(*store)->Delete(EntryKind::kModel, id).ok()) _exit(1);
        if (write(ends[1], "x", 1) != 1) _exit(1);
      }
      _exit(1);
    }
    close(ends[1]);
    char beats[1];
    for (int beat = 0; beat < 15 + 4 * round; ++beat) ASSERT_EQ(read(ends[0], beats, 1), 1);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(ends[0]);
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto store, Store::Open({.data_dir = folder.path()}));
    EXPECT_TRUE(store->missing_files().empty());
    EXPECT_TRUE(store->catalog().PendingRemovals()->empty());
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto entries, store->catalog().List(EntryKind::kModel));
    EXPECT_FALSE(entries.empty());
    for (const CatalogEntry& entry : entries) {
      EXPECT_EQ(store->blobs().Get(entry.id).value_or("missing"), entry.record);
    }
    EXPECT_EQ(store->blobs().List()->size(), entries.size());
  }
}

}  // namespace
}  // namespace pleat
