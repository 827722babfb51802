#include "pleat/store/blob_store.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "store/sync_gate.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(BlobStoreTest, KeepsContentUnderItsHash) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.File("blobs"), 0));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string id, blobs.Put("hello"));
  EXPECT_EQ(id, ToHex(ComputeSha256("hello")));
  EXPECT_EQ(blobs.Put("hello").value(), id);
  EXPECT_EQ(blobs.List()->size(), 1u);
  EXPECT_EQ(blobs.Get(id).value(), "hello");
  EXPECT_EQ(blobs.Size(id).value(), 5u);
  EXPECT_EQ(blobs.OpenForReading(id).value()->Read(1, 3).value(), "ell");
  EXPECT_THAT(blobs.Delete(id), IsOk());
  EXPECT_THAT(blobs.Get(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(blobs.OpenForReading(id), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
  EXPECT_THAT(blobs.Delete(id), IsOk());
}

TEST(BlobStoreTest, IdsNeverBecomeOtherPaths) {
  TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("secret"), "secret"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.File("blobs"), 0));
  for (const std::string& id :
       {std::string("../secret"), std::string(), std::string("ab"), std::string(64, 'G'),
        "../" + std::string(61, 'a'), std::string(63, 'a') + std::string(1, '\0')}) {
    EXPECT_THAT(blobs.Get(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
    EXPECT_THAT(blobs.Delete(id), IsOk());
  }
  EXPECT_TRUE(std::filesystem::exists(folder.File("secret")));
}

TEST(BlobStoreTest, NoticesWhenTheDiskGivesOtherBytes) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string id, blobs.Put("hello"));
  std::ofstream(folder.path() + "/" + id.substr(0, 2) + "/" + id) << "jello";
  EXPECT_THAT(blobs.Get(id), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("changed")));
}

TEST(BlobStoreTest, RemovesUnfinishedWritesOfACrash) {
  TemporaryFolder folder;
  const std::string unfinished = folder.File("aa/" + std::string(64, 'a') + ".tmp-123456");
  // Names that Stage never gives are somebody else's files.
  const std::string others[] = {folder.File("ab/abc.tmp-123456"), folder.File("notes.tmp-123456"),
                                folder.File("aa/" + std::string(64, 'a') + ".tmp-1234567")};
  ASSERT_THAT(WriteFile(unfinished, "half"), IsOk());
  for (const std::string& other : others) ASSERT_THAT(WriteFile(other, "mine"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  EXPECT_FALSE(std::filesystem::exists(unfinished));
  for (const std::string& other : others) EXPECT_TRUE(std::filesystem::exists(other)) << other;
}

TEST(BlobStoreTest, DamageIsFoundAndStoringTheContentAgainMendsIt) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  const std::string content(3'000'000, 'x');  // several steps
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string id, blobs.Put(content));
  EXPECT_THAT(blobs.Verify(id), IsOk());
  for (const size_t offset : {size_t{0}, content.size() - 1}) {
    std::fstream(blobs.PathOf(id), std::ios::in | std::ios::out | std::ios::binary)
        .seekp(static_cast<std::streamoff>(offset))
        .put('y');
    EXPECT_THAT(blobs.Verify(id), HasStatus(absl::StatusCode::kDataLoss, HasSubstr(id)));
    // No path of the server in any text.
    EXPECT_THAT(blobs.Get(id).status().message(), testing::Not(HasSubstr(folder.path())));
    EXPECT_EQ(blobs.Put(content).value(), id);
    EXPECT_THAT(blobs.Verify(id), IsOk());
  }
  ASSERT_THAT(blobs.Delete(id), IsOk());
  EXPECT_THAT(blobs.Verify(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST(BlobStoreTest, OpenedReadOnlyItChangesNothing) {
  TemporaryFolder folder;
  const std::string unfinished = folder.File("aa/" + std::string(64, 'a') + ".tmp-123456");
  ASSERT_THAT(WriteFile(unfinished, "half"), IsOk());
  const BlobStore blobs = BlobStore::OpenReadOnly(folder.path());
  EXPECT_TRUE(blobs.List()->empty());
  EXPECT_TRUE(std::filesystem::exists(unfinished));
  EXPECT_FALSE(BlobStore::OpenReadOnly(folder.File("missing")).List().ok());
  EXPECT_FALSE(std::filesystem::exists(folder.File("missing")));
}

TEST(BlobStoreTest, KeepsTheReserve) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      BlobStore blobs, BlobStore::Open(folder.path(), std::numeric_limits<uint64_t>::max() / 2));
  EXPECT_THAT(blobs.Put("hello"),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("reserve")));
  EXPECT_TRUE(blobs.List()->empty());
}

TEST(BlobStoreTest, AStagedFileIsSeenOnlyWhenItIsPublished) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  std::string path;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const StagedFile unpublished, blobs.Stage("hello"));
    path = unpublished.path();
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_FALSE(blobs.Contains(unpublished.id()));
    EXPECT_TRUE(blobs.List()->empty());
  }
  EXPECT_FALSE(std::filesystem::exists(path));  // nobody wanted it
  PLEAT_ASSERT_OK_AND_ASSIGN(StagedFile file, blobs.Stage("hello"));
  const std::string id = file.id();
  ASSERT_THAT(blobs.Publish(std::move(file)), IsOk());
  EXPECT_EQ(blobs.Get(id).value(), "hello");
  PLEAT_ASSERT_OK_AND_ASSIGN(StagedFile again, blobs.Stage("hello"));
  EXPECT_TRUE(again.already_stored());
  ASSERT_THAT(blobs.Delete(id), IsOk());
  EXPECT_THAT(blobs.Publish(std::move(again)),
              HasStatus(absl::StatusCode::kAborted, HasSubstr("deleted")));
}

TEST(BlobStoreTest, SyncsTheContentBeforeTheNames) {
  TemporaryFolder folder;
  SyncGate gate;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0, gate.hook()));
  PLEAT_ASSERT_OK_AND_ASSIGN(StagedFile file, blobs.Stage("hello"));
  EXPECT_THAT(gate.TakePaths(), ElementsAre(file.path()));
  const std::string shard = folder.File(file.id().substr(0, 2));
  ASSERT_THAT(blobs.Publish(std::move(file)), IsOk());
  EXPECT_THAT(gate.TakePaths(), ElementsAre(shard, folder.path()));
}

TEST(BlobStoreTest, ManyWritersOfTheSameContent) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  const std::string content(100'000, 'x');
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int round = 0; round < 5; ++round) EXPECT_TRUE(blobs.Put(content).ok());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(blobs.List()->size(), 1u);
  EXPECT_EQ(blobs.Get(blobs.List()->front()).value(), content);
}

TEST(BlobStoreTest, NoDiskHasRoomForTheLargestNumber) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  EXPECT_EQ(blobs.ReserveSpace(std::numeric_limits<uint64_t>::max()).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(BlobStoreTest, FilesOfOthersAreNeitherListedNorRemoved) {
  TemporaryFolder folder;
  const std::string id(64, 'a');
  for (const char* name : {"README", "ab/notes.txt", "ab/.tmp-hidden/x"}) {
    ASSERT_THAT(WriteFile(folder.File(name), "mine"), IsOk());
  }
  std::filesystem::create_directories(folder.File("aa/" + id));  // the name of a file
  PLEAT_ASSERT_OK_AND_ASSIGN(const BlobStore blobs, BlobStore::Open(folder.path(), 0));
  for (const char* name : {"README", "ab/notes.txt"}) {
    EXPECT_EQ(ReadFile(folder.File(name)).value_or(""), "mine") << name;
  }
  EXPECT_FALSE(blobs.Contains(id));
  EXPECT_THAT(blobs.Get(id), HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST(BlobStoreTest, PublishingMakesAFolderThatIsGoneAndMissesAFileThatIs) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(BlobStore blobs, BlobStore::Open(folder.path(), 0));
  const std::string elsewhere = folder.File("elsewhere");
  ASSERT_THAT(WriteFile(elsewhere, "hello"), IsOk());
  const std::string id = ToHex(ComputeSha256("hello"));
  ASSERT_THAT(blobs.Publish(StagedFile(id, elsewhere, StagedFile::Unpublished::kRemove)), IsOk());
  EXPECT_EQ(blobs.Get(id).value(), "hello");
  PLEAT_ASSERT_OK_AND_ASSIGN(StagedFile file, blobs.Stage("bye"));
  std::filesystem::remove(file.path());
  EXPECT_THAT(blobs.Publish(std::move(file)),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("cannot store")));
  EXPECT_THAT(blobs.List().value(), ElementsAre(id));
}

TEST(StagedFileTest, OnlyTheLastOwnerRemovesTheFile) {
  TemporaryFolder folder;
  const std::string path = folder.File("x");
  ASSERT_THAT(WriteFile(path, "hello"), IsOk());
  {
    StagedFile first("id", path, StagedFile::Unpublished::kRemove);
    { const StagedFile second("id", path, StagedFile::Unpublished::kKeep); }
    EXPECT_TRUE(std::filesystem::exists(path));  // it was not its own to remove
    const StagedFile third(std::move(first));
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_EQ(third.path(), path);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace pleat
