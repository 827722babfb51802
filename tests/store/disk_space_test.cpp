#include "pleat/store/disk_space.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <utility>

#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class DiskSpaceTest : public testing::Test {
 protected:
  uint64_t free_bytes_ = 1000;
  const std::shared_ptr<DiskSpace> space_ = std::make_shared<DiskSpace>(
      [this]() -> absl::StatusOr<uint64_t> { return free_bytes_; }, /*reserve_bytes=*/100);
};

TEST_F(DiskSpaceTest, WritersThatBeginTogetherShareWhatIsFree) {
  PLEAT_ASSERT_OK_AND_ASSIGN(SpaceReservation first, space_->Reserve(600));
  EXPECT_THAT(space_->Reserve(600),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("600 are promised")));
  EXPECT_THAT(space_->Reserve(300), IsOk());
  first = SpaceReservation();
  EXPECT_THAT(space_->Reserve(900), IsOk());
}

TEST_F(DiskSpaceTest, WhatIsWrittenIsCountedOnce) {
  PLEAT_ASSERT_OK_AND_ASSIGN(SpaceReservation writer, space_->Reserve(600));
  writer.Spend(200);
  free_bytes_ = 800;  // the disk counts it now
  EXPECT_EQ(writer.bytes(), 400u);
  EXPECT_THAT(space_->Reserve(300), IsOk());
  EXPECT_THAT(space_->Reserve(301), HasStatus(absl::StatusCode::kResourceExhausted, _));
  writer.Spend(10'000);  // more than was promised
  EXPECT_EQ(writer.bytes(), 0u);
  EXPECT_THAT(space_->Reserve(700), IsOk());
}

TEST_F(DiskSpaceTest, AMovedReservationIsGivenBackOnce) {
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(SpaceReservation a, space_->Reserve(500));
    SpaceReservation b = std::move(a);
    a = std::move(b);
    EXPECT_EQ(a.bytes(), 500u);
    EXPECT_THAT(space_->Reserve(401), HasStatus(absl::StatusCode::kResourceExhausted, _));
  }
  EXPECT_THAT(space_->Reserve(900), IsOk());
}

TEST_F(DiskSpaceTest, TheReserveStaysFree) {
  EXPECT_THAT(space_->Reserve(901), HasStatus(absl::StatusCode::kResourceExhausted, _));
  for (const uint64_t bytes : {uint64_t{1} << 63, std::numeric_limits<uint64_t>::max()}) {
    EXPECT_THAT(space_->Reserve(bytes), HasStatus(absl::StatusCode::kResourceExhausted, _));
  }
  free_bytes_ = 50;
  EXPECT_THAT(space_->Reserve(1), HasStatus(absl::StatusCode::kResourceExhausted, _));
}

TEST(DiskSpaceOfFolderTest, AsksTheDisk) {
  TemporaryFolder folder;
  const auto space = DiskSpace::Of(folder.path(), 0);
  EXPECT_THAT(space->Reserve(1), IsOk());
  EXPECT_THAT(space->Reserve(uint64_t{1} << 60),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_FALSE(DiskSpace::Of(folder.File("missing"), 0)->Reserve(1).ok());
}

}  // namespace
}  // namespace pleat
