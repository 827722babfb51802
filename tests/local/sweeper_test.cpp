#include "pleat/local/sweeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <string>

#include "data_folder.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(SweeperTest, ItsThreadRunsRetentionAgainAndAgainAndEnds) {
  DataFolder folder;
  folder.Open();
  const auto id = [&] {
    return folder.sequences().Upload(MakeSwayingTube(3, "a"), {}, absl::Seconds(1))->id;
  };
  std::promise<std::string> removed;
  std::once_flag once;
  const RetentionTarget target{.files = &folder.files(),
                               .on_removed = [&](const std::string& sentence) {
                                 std::call_once(once, [&] { removed.set_value(sentence); });
                               }};
  const std::string uploaded = id();
  folder.Pass(absl::Seconds(1));
  {
    const Sweeper sweeper(target, {}, 1e-3);
    EXPECT_THAT(removed.get_future().get(), testing::HasSubstr(uploaded));
  }
  EXPECT_FALSE(folder.sequences().Get(uploaded).ok());
  { const Sweeper slow(target, {}, 1e9); }  // ends at once although its pause is long
}

}  // namespace
}  // namespace pleat
