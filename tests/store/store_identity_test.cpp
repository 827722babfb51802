#include "store_identity.h"

#include <gtest/gtest.h>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const char kOne[] = "11111111111111111111111111111111";
const char kTwo[] = "22222222222222222222222222222222";

absl::StatusOr<std::string> Agree(const StoreSides& sides) {
  return AgreeOnStoreId(sides, "/data");
}

auto Refuses(const std::string& why) {
  return HasStatus(absl::StatusCode::kFailedPrecondition,
                   AllOf(HasSubstr(why), HasSubstr("/data"), HasSubstr("pleat store repair"),
                         HasSubstr("nothing was changed")));
}

TEST(StoreIdentityTest, ANewStoreNeedsAnId) {
  EXPECT_EQ(Agree({}).value(), "");
  const std::string id = MakeStoreId();
  EXPECT_EQ(id.size(), 32u);
  EXPECT_NE(id, MakeStoreId());
}

TEST(StoreIdentityTest, EqualIdsAgreeWhateverTheFilesAre) {
  EXPECT_EQ(Agree({.catalog_id = kOne, .blobs_id = kOne}).value(), kOne);
  EXPECT_EQ(Agree({.catalog_id = kOne, .blobs_id = kOne, .num_named = 3}).value(), kOne);
  EXPECT_EQ(Agree({.catalog_id = kOne, .blobs_id = kOne, .num_files = 3}).value(), kOne);
}

TEST(StoreIdentityTest, DifferentIdsNeverAgree) {
  EXPECT_THAT(Agree({.catalog_id = kOne, .blobs_id = kTwo}), Refuses(kTwo));
  EXPECT_THAT(
      Agree(
          {.catalog_id = kOne, .blobs_id = kTwo, .num_named = 3, .num_files = 3, .num_common = 3}),
      Refuses(kOne));
}

// Stores of 0.1.0 have no id, and a crash may leave one side without it.
TEST(StoreIdentityTest, ASideWithoutIdIsKnownByItsFiles) {
  const StoreSides same{.num_named = 3, .num_files = 4, .num_common = 1};
  EXPECT_EQ(Agree(same).value(), "");
  StoreSides catalog = same, blobs = same;
  catalog.catalog_id = kOne;
  blobs.blobs_id = kTwo;
  EXPECT_EQ(Agree(catalog).value(), kOne);
  EXPECT_EQ(Agree(blobs).value(), kTwo);
  EXPECT_EQ(Agree({.blobs_id = kTwo}).value(), kTwo);
}

TEST(StoreIdentityTest, ACatalogThatKnowsNoneOfTheFilesIsRefused) {
  for (const char* id : {"", kTwo}) {
    EXPECT_THAT(Agree({.blobs_id = id, .num_files = 8}), Refuses("the files beside it are 8"));
    EXPECT_THAT(Agree({.blobs_id = id, .num_named = 5, .num_files = 8}),
                Refuses("none of them is among the 8"));
  }
  for (const char* id : {"", kOne}) {
    EXPECT_THAT(Agree({.catalog_id = id, .num_named = 5}), Refuses("is a disk not mounted?"));
  }
}

TEST(StoreIdentityTest, TheIdInTheFolderIsReadAndChecked) {
  TemporaryFolder folder;
  EXPECT_EQ(ReadBlobsId(folder.path()).value(), "");
  ASSERT_THAT(WriteBlobsId(folder.path(), kOne), IsOk());
  EXPECT_EQ(ReadBlobsId(folder.path()).value(), kOne);
  for (const std::string& damaged :
       {std::string("zz"), std::string(32, 'x'), std::string(1000, 'a'), std::string()}) {
    ASSERT_THAT(WriteFile(folder.File("STORE"), damaged), IsOk());
    EXPECT_FALSE(ReadBlobsId(folder.path()).ok()) << damaged;
  }
}

}  // namespace
}  // namespace pleat
