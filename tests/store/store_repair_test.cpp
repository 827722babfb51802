#include "pleat/store/store_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/store/store_check.h"
#include "store/sample_store.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

class StoreRepairTest : public testing::Test {
 protected:
  // Knows every file but those that begin with "nonsense".
  static absl::StatusOr<FileDescription> Describe(const std::string& id, const std::string& bytes) {
    EXPECT_EQ(id, IdOf(bytes));
    if (bytes.starts_with("nonsense")) return absl::InvalidArgumentError("nonsense");
    return FileDescription{EntryKind::kSequence, SampleStore::RecordOf(bytes)};
  }
  StoreRepair Repair() {
    absl::StatusOr<StoreRepair> repair = RepairStore(sample_.data_dir(), Describe);
    EXPECT_THAT(repair, IsOk());
    return repair.value_or(StoreRepair());
  }
  void ExpectSound(size_t num_files) {
    const auto store = sample_.Open();
    EXPECT_THAT(store->missing_files(), IsEmpty());
    PLEAT_ASSERT_OK_AND_ASSIGN(const StoreCheck check, CheckStore(sample_.data_dir(), true));
    EXPECT_THAT(check.problems, IsEmpty());
    EXPECT_EQ(check.num_files, num_files);
    EXPECT_EQ(check.num_entries[static_cast<size_t>(EntryKind::kSequence)], num_files);
  }
  std::string Catalog() const { return sample_.data_dir() + "/catalogue.db"; }

  SampleStore sample_;
};

TEST_F(StoreRepairTest, ASoundStoreStaysAsItIs) {
  const StoreRepair repair = Repair();
  EXPECT_FALSE(repair.has_new_catalog);
  for (const auto* ids :
       {&repair.rows_made, &repair.returned, &repair.damaged, &repair.unknown, &repair.missing}) {
    EXPECT_THAT(*ids, IsEmpty());
  }
  ExpectSound(3);
}

TEST_F(StoreRepairTest, RowsAreMadeAnewFromTheFiles) {
  for (const bool damaged : {false, true}) {
    if (damaged) {
      ASSERT_THAT(WriteFile(Catalog(), std::string(9000, 'x')), IsOk());
    } else {
      std::filesystem::remove(Catalog());
    }
    EXPECT_FALSE(Store::Open({.data_dir = sample_.data_dir()}).ok());
    const StoreRepair repair = Repair();
    EXPECT_EQ(repair.has_new_catalog, damaged);
    EXPECT_THAT(repair.rows_made, UnorderedElementsAre(IdOf("zero"), IdOf("one"), IdOf("two")));
    ExpectSound(3);
  }
  EXPECT_TRUE(std::filesystem::exists(sample_.data_dir() + "/quarantine/catalogue.db"));
}

TEST_F(StoreRepairTest, ARowThatCannotBeReadIsReplaced) {
  sample_.BreakRow("one");
  EXPECT_THAT(Repair().rows_made, ElementsAre(IdOf("one")));
  ExpectSound(3);
}

TEST_F(StoreRepairTest, WhatTheQuarantineHasIntactComesBack) {
  {
    const auto catalog = pleat::Catalog::Open(Catalog()).value();
    ASSERT_THAT(catalog->Delete(EntryKind::kSequence, IdOf("one")), IsOk());
    ASSERT_THAT(catalog->ForgetRemoval(IdOf("one")), IsOk());
  }
  sample_.Damage("two");
  sample_.Open()->Verify(IdOf("two")).IgnoreError();  // both are in quarantine now
  const StoreRepair repair = Repair();
  EXPECT_THAT(repair.returned, ElementsAre(IdOf("one")));
  EXPECT_THAT(repair.rows_made, ElementsAre(IdOf("one")));
  EXPECT_THAT(repair.missing, ElementsAre(IdOf("two")));
  EXPECT_TRUE(std::filesystem::exists(sample_.data_dir() + "/quarantine/" + IdOf("two")));
  const auto store = sample_.Open();
  EXPECT_EQ(store->Read(IdOf("one")).value(), "one");
}

TEST_F(StoreRepairTest, DamageGoesToQuarantineAndItsEntryIsNamed) {
  sample_.Damage("two");
  const StoreRepair repair = Repair();
  EXPECT_THAT(repair.damaged, ElementsAre(IdOf("two")));
  EXPECT_THAT(repair.missing, ElementsAre(IdOf("two")));
  EXPECT_FALSE(std::filesystem::exists(sample_.PathOf("two")));
}

TEST_F(StoreRepairTest, WhatNobodyKnowsStays) {
  ASSERT_THAT(WriteFile(sample_.PathOf("nonsense"), "nonsense"), IsOk());
  EXPECT_THAT(Repair().unknown, ElementsAre(IdOf("nonsense")));
  EXPECT_TRUE(std::filesystem::exists(sample_.PathOf("nonsense")));
}

TEST_F(StoreRepairTest, SidesThatDoNotFitGetOneId) {
  const std::string path = sample_.data_dir() + "/blobs/STORE";
  for (const std::string& wrong : {std::string(32, 'a') + "\n", std::string("nonsense")}) {
    ASSERT_THAT(WriteFile(path, wrong), IsOk());
    EXPECT_FALSE(Store::Open({.data_dir = sample_.data_dir()}).ok());
    Repair();
    ExpectSound(3);
  }
}

TEST_F(StoreRepairTest, NeedsTheFolderForItself) {
  const auto store = sample_.Open();
  EXPECT_THAT(RepairStore(sample_.data_dir(), Describe).status(),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  EXPECT_THAT(RepairStore(sample_.File("missing"), Describe).status(),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("blobs")));
  EXPECT_FALSE(std::filesystem::exists(sample_.File("missing")));
}

}  // namespace
}  // namespace pleat
