#include "pleat/store/catalog.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "pleat/base/file.h"
#include "store/sync_gate.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(CatalogTest, KeepsEntriesInOrderAcrossRestarts) {
  TemporaryFolder folder;
  const std::string binary("\0\xff\n'\"", 5);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
    for (const char* id : {"b", "a", "c"}) {
      ASSERT_THAT(catalog->Put(EntryKind::kJob, {id, binary, 1}), IsOk());
    }
    ASSERT_THAT(catalog->Put(EntryKind::kJob, {"a", "changed", 2}), IsOk());
    ASSERT_THAT(catalog->Put(EntryKind::kModel, {"a", "model", 0}), IsOk());
    ASSERT_THAT(catalog->Delete(EntryKind::kJob, "c"), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto jobs, catalog->List(EntryKind::kJob));
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].id, "b");
  EXPECT_EQ(jobs[0].record, binary);
  EXPECT_EQ(jobs[1].id, "a");
  EXPECT_EQ(jobs[1].record, "changed");
  EXPECT_EQ(jobs[1].attempts, 2);
  EXPECT_EQ(catalog->Get(EntryKind::kModel, "a")->record, "model");
  EXPECT_THAT(catalog->Get(EntryKind::kJob, "c"),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no job 'c'")));
  EXPECT_THAT(catalog->Delete(EntryKind::kJob, "c"),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_TRUE(catalog->List(EntryKind::kSequence)->empty());
}

// A child writes as fast as it can and is killed; every write that it reported must be there.
TEST(CatalogTest, ReportedWritesSurviveAKill) {
  TemporaryFolder folder;
  for (int round = 0; round < 3; ++round) {
    int pipe_fds[2];
    ASSERT_EQ(pipe(pipe_fds), 0);
    const pid_t child = fork();
    if (child == 0) {
      auto catalog = Catalog::Open(folder.File("c.db"));
      for (int i = 0; catalog.ok(); ++i) {
        const std::string id = std::to_string(round) + "/" + std::to_string(i);
        if (!(*catalog)->Put(EntryKind::kJob, {id, "r", 0}).ok()) _exit(1);
        if (write(pipe_fds[1], &i, sizeof i) != sizeof i) _exit(1);
      }
      _exit(1);
    }
    close(pipe_fds[1]);
    int last = -1, value = 0;
    while (last < 20 && read(pipe_fds[0], &value, sizeof value) == sizeof value) last = value;
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(pipe_fds[0], &value, sizeof value) == sizeof value) last = value;
    close(pipe_fds[0]);
    ASSERT_GE(last, 20);
    PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
    for (int i = 0; i <= last; ++i) {
      EXPECT_THAT(catalog->Get(EntryKind::kJob, std::to_string(round) + "/" + std::to_string(i)),
                  IsOk());
    }
  }
}

TEST(CatalogTest, RefusesDamageAndNewerVersions) {
  TemporaryFolder folder;
  std::ofstream(folder.File("damaged.db")) << std::string(8192, 'x');
  EXPECT_THAT(Catalog::Open(folder.File("damaged.db")),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("catalog")));
  EXPECT_FALSE(Catalog::Open(folder.File("no/such/folder.db")).ok());
  ASSERT_THAT(Catalog::Open(folder.File("newer.db")), IsOk());
  {
    // user_version: four bytes, big-endian, at offset 60 of the file (sqlite.org/fileformat.html).
    std::fstream file(folder.File("newer.db"), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(60).write("\0\0\0\x09", 4);
  }
  EXPECT_THAT(Catalog::Open(folder.File("newer.db")),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("version 9")));
}

TEST(CatalogTest, AReadDoesNotWaitForTheSyncOfAWrite) {
  TemporaryFolder folder;
  SyncGate gate;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db"), gate.hook()));
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"a", "old", 0}), IsOk());
  gate.Close(PathEndsWith("c.db-wal"));
  std::thread writer([&] {
    EXPECT_THAT(catalog->Put(EntryKind::kModel, {"a", "new", 0}), IsOk());
  });
  gate.WaitForOneThatWaits();
  // What is not durable yet cannot be seen.
  EXPECT_EQ(catalog->Get(EntryKind::kModel, "a")->record, "old");
  EXPECT_EQ(catalog->List(EntryKind::kModel)->size(), 1u);
  gate.Open();
  writer.join();
  EXPECT_EQ(catalog->Get(EntryKind::kModel, "a")->record, "new");
}

TEST(CatalogTest, EveryWriteIsSynced) {
  TemporaryFolder folder;
  SyncGate gate;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db"), gate.hook()));
  gate.TakePaths();
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"a", "r", 0}), IsOk());
  EXPECT_FALSE(gate.TakePaths().empty());
  ASSERT_THAT(catalog->Delete(EntryKind::kModel, "a"), IsOk());
  EXPECT_FALSE(gate.TakePaths().empty());
  ASSERT_THAT(catalog->List(EntryKind::kModel), IsOk());
  EXPECT_TRUE(gate.TakePaths().empty());
}

TEST(CatalogTest, ManyThreads) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 10; ++round) {
        const std::string id = std::to_string(i * 100 + round);
        EXPECT_TRUE(catalog->Put(EntryKind::kJob, {id, "r", 0}).ok());
        EXPECT_TRUE(catalog->Get(EntryKind::kJob, id).ok());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(catalog->List(EntryKind::kJob)->size(), 40u);
}

TEST(CatalogTest, IdsAreNeverReadAsSql) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
  const std::vector<std::string> ids = {"",
                                        "'",
                                        "' OR 1=1 --",
                                        "x'); DROP TABLE entries; --",
                                        "%",
                                        "?1",
                                        std::string("a\0b", 3),
                                        std::string("a\0c", 3),
                                        std::string(5000, 'i')};
  for (const std::string& id : ids) {
    ASSERT_THAT(catalog->Put(EntryKind::kModel, {id, "record of " + id, 0}), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto entries, catalog->List(EntryKind::kModel));
  ASSERT_EQ(entries.size(), ids.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(entries[i].id, ids[i]);
    EXPECT_EQ(catalog->Get(EntryKind::kModel, ids[i])->record, "record of " + ids[i]);
    ASSERT_THAT(catalog->Delete(EntryKind::kModel, ids[i]), IsOk());
    EXPECT_EQ(catalog->List(EntryKind::kModel)->size(), ids.size() - i - 1);
  }
}

TEST(CatalogTest, KindsWithOneIdAreStrangers) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(folder.File("c.db")));
  const std::vector<EntryKind> kinds = {EntryKind::kSequence, EntryKind::kModel,
                                        EntryKind::kCompressedSequence, EntryKind::kJob,
                                        EntryKind::kRig};
  for (size_t k = 0; k < kinds.size(); ++k) {
    ASSERT_THAT(catalog->Put(kinds[k], {"same", std::string(k, 'r'), static_cast<int>(k)}), IsOk());
  }
  for (size_t k = 0; k < kinds.size(); ++k) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const CatalogEntry entry, catalog->Get(kinds[k], "same"));
    EXPECT_EQ(entry.record.size(), k);
    EXPECT_EQ(entry.attempts, static_cast<int>(k));
    ASSERT_THAT(catalog->Delete(kinds[k], "same"), IsOk());
    for (size_t other = 0; other < kinds.size(); ++other) {
      EXPECT_EQ(catalog->Get(kinds[other], "same").ok(), other > k);
    }
  }
}

// Whatever stands in the file, a start or a read says so; none gives entries that were never there.
TEST(CatalogTest, DamageAnywhereIsNeverBelieved) {
  TemporaryFolder folder;
  const std::string path = folder.File("c.db");
  std::set<std::string> records;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto catalog, Catalog::Open(path));
    for (int i = 0; i < 60; ++i) {
      const std::string record(300, static_cast<char>('A' + i));
      records.insert(record);
      ASSERT_THAT(catalog->Put(EntryKind::kJob, {std::to_string(i), record, 0}), IsOk());
    }
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string good, ReadFile(path));
  for (size_t size = 0; size < good.size(); size += 4096) {  // whole pages are missing
    ASSERT_THAT(WriteFile(path, good.substr(0, size)), IsOk());
    const auto catalog = Catalog::Open(path);
    if (size == 0) {  // a new catalog
      EXPECT_THAT(catalog, IsOk());
    } else {
      EXPECT_FALSE(catalog.ok() && (*catalog)->List(EntryKind::kJob).ok()) << size;
    }
    for (const char* log : {"-wal", "-shm"}) std::filesystem::remove(path + log);
  }
  // The first bytes of each page say what it is.
  for (size_t page = 0; page < good.size(); page += 4096) {
    std::string damaged = good;
    damaged.replace(page, 8, 8, '\x7f');
    ASSERT_THAT(WriteFile(path, damaged), IsOk());
    const auto catalog = Catalog::Open(path);
    const auto entries = catalog.ok() ? (*catalog)->List(EntryKind::kJob)
                                      : absl::StatusOr<std::vector<CatalogEntry>>(catalog.status());
    if (!entries.ok()) continue;
    for (const CatalogEntry& entry : *entries) EXPECT_TRUE(records.contains(entry.record));
  }
}

TEST(CatalogTest, ADeletedEntryLeavesItsFileToBeRemoved) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  for (const EntryKind kind : {EntryKind::kModel, EntryKind::kSequence, EntryKind::kJob}) {
    ASSERT_THAT(catalog->Put(kind, {std::string(EntryKindName(kind)), "", 0}), IsOk());
    ASSERT_THAT(catalog->Delete(kind, EntryKindName(kind)), IsOk());
  }
  EXPECT_THAT(catalog->PendingRemovals().value(), testing::ElementsAre("model", "sequence"));
  ASSERT_THAT(catalog->Put(EntryKind::kRig, {"model", "", 0}), IsOk());  // whatever its kind
  ASSERT_THAT(catalog->ForgetRemoval("sequence"), IsOk());
  EXPECT_TRUE(catalog->PendingRemovals()->empty());
  EXPECT_THAT(catalog->FileIds().value(), testing::ElementsAre("model"));
  EXPECT_TRUE(catalog->NamesFile("model").value());
  EXPECT_FALSE(catalog->NamesFile("sequence").value());
}

TEST(CatalogTest, ForgettingARemovalWaitsForNoSync) {
  TemporaryFolder folder;
  SyncGate gate;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db"), gate.hook()));
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"a", "", 0}), IsOk());
  ASSERT_THAT(catalog->Delete(EntryKind::kModel, "a"), IsOk());
  gate.TakePaths();
  ASSERT_THAT(catalog->ForgetRemoval("a"), IsOk());
  EXPECT_TRUE(gate.TakePaths().empty());
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"b", "", 0}), IsOk());
  EXPECT_FALSE(gate.TakePaths().empty());
}

TEST(CatalogTest, KnowsItsStore) {
  TemporaryFolder folder;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
    EXPECT_EQ(catalog->StoreId().value(), "");
    ASSERT_THAT(catalog->SetStoreId("first"), IsOk());
    ASSERT_THAT(catalog->SetStoreId("second"), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  EXPECT_EQ(catalog->StoreId().value(), "second");
}

TEST(CatalogTest, ReadOnlyItIsReadBesideAWriterAndChangesNothing) {
  TemporaryFolder folder;
  EXPECT_FALSE(Catalog::OpenReadOnly(folder.File("c.db")).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.File("c.db")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto writer, Catalog::Open(folder.File("c.db")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto reader, Catalog::OpenReadOnly(folder.File("c.db")));
  ASSERT_THAT(writer->Put(EntryKind::kModel, {"a", "r", 0}), IsOk());
  EXPECT_EQ(reader->Get(EntryKind::kModel, "a")->record, "r");
  EXPECT_THAT(reader->Put(EntryKind::kModel, {"b", "", 0}),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("readonly")));
}

TEST(CatalogTest, ACopyHoldsTheEntriesOfOneMoment) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"a", "r", 0}), IsOk());
  ASSERT_THAT(catalog->CopyTo(folder.File("copy.db")), IsOk());
  ASSERT_THAT(catalog->Put(EntryKind::kModel, {"b", "r", 0}), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto copy, Catalog::Open(folder.File("copy.db")));
  EXPECT_THAT(copy->FileIds().value(), testing::ElementsAre("a"));
}

}  // namespace
}  // namespace pleat
