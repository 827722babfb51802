#include "pleat/store/store.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(StoreTest, OneProcessPerFolder) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.File("data")}));
  EXPECT_THAT(Store::Open({.data_dir = folder.File("data")}),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  store.reset();
  EXPECT_THAT(Store::Open({.data_dir = folder.File("data")}), IsOk());
}

TEST(StoreTest, RemovesFilesWithoutRowAndReportsRowsWithoutFile) {
  TemporaryFolder folder;
  std::string kept, orphan, lost;
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.path()}));
    kept = store->blobs().Put("kept").value();
    orphan = store->blobs().Put("orphan").value();
    lost = store->blobs().Put("lost").value();
    ASSERT_THAT(store->catalogue().Put(EntryKind::kModel, {kept, "", 0}), IsOk());
    ASSERT_THAT(store->catalogue().Put(EntryKind::kSequence, {lost, "", 0}), IsOk());
    ASSERT_THAT(store->blobs().Delete(lost), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(auto store, Store::Open({.data_dir = folder.path()}));
  EXPECT_TRUE(store->blobs().Contains(kept));
  EXPECT_FALSE(store->blobs().Contains(orphan));
  EXPECT_THAT(store->missing_files(), ElementsAre(lost));
}

TEST(StoreTest, SaysWhyItCannotStart) {
  EXPECT_THAT(Store::Open({}), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  EXPECT_FALSE(Store::Open({.data_dir = "/proc/no-such-place"}).ok());
  TemporaryFolder folder;
  EXPECT_THAT(Store::Open({.data_dir = folder.path(), .reserve_bytes = uint64_t{1} << 60}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("room")));
}

}  // namespace
}  // namespace pleat
