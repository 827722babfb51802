#include "pleat/local/scrubber.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <future>
#include <mutex>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ScrubberTest : public testing::Test {
 protected:
  std::string Add(const std::string& bytes) {
    const std::string id = ToHex(ComputeSha256(bytes));
    EXPECT_THAT(store_->Add(EntryKind::kModel, {id, ""}, bytes), IsOk());
    return id;
  }
  std::string PathOf(const std::string& id) { return store_->blobs().PathOf(id); }
  bool Pass(const Scrubber::Pause& pause) { return Scrubber::RunPass(store_.get(), 100, pause); }
  bool Pass() {
    return Pass([](double) { return true; });
  }

  TemporaryFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> problems_;  // guarded by mutex_
  std::function<void()> on_problem_;
  const std::unique_ptr<Store> store_ = Store::Open({.data_dir = folder_.path(),
                                                     .reserve_bytes = 0,
                                                     .on_problem =
                                                         [this](const std::string& problem) {
                                                           {
                                                             std::lock_guard lock(mutex_);
                                                             problems_.push_back(problem);
                                                           }
                                                           if (on_problem_) on_problem_();
                                                         }})
                                            .value();
};

TEST_F(ScrubberTest, APassTakesItsPeriodWhateverTheFiles) {
  for (const size_t size : {10, 1000, 0, 100'000}) Add(std::string(size, 'x'));
  double seconds = 0, longest = 0;
  EXPECT_TRUE(Pass([&](double pause) {
    seconds += pause;
    longest = std::max(longest, pause);
    return true;
  }));
  EXPECT_NEAR(seconds, 100, 1e-9);
  EXPECT_GT(longest, 98);  // the time goes by bytes
  EXPECT_THAT(problems_, IsEmpty());
}

TEST_F(ScrubberTest, AnEmptyStoreIsNoBusyLoop) {
  std::vector<double> pauses;
  EXPECT_TRUE(Pass([&](double pause) {
    pauses.push_back(pause);
    return true;
  }));
  EXPECT_THAT(pauses, ElementsAre(100));
}

TEST_F(ScrubberTest, FindsDamageAndGoesOn) {
  const std::string a = Add("aaaa"), b = Add("bbbb"), c = Add("cccc");
  for (const std::string& id : {a, c}) ASSERT_THAT(WriteFile(PathOf(id), "????"), IsOk());
  EXPECT_TRUE(Pass());
  EXPECT_EQ(problems_.size(), 2u);
  EXPECT_EQ(store_->quarantine().List()->size(), 2u);
  EXPECT_EQ(store_->Read(b).value(), "bbbb");
}

TEST_F(ScrubberTest, NamesAFileThatIsGoneAndNotOneThatWasDeleted) {
  const std::string gone = Add("gone"), deleted = Add("deleted");
  std::filesystem::remove(PathOf(gone));
  int num_pauses = 0;
  EXPECT_TRUE(Pass([&](double) {
    if (num_pauses++ == 0) {
      EXPECT_THAT(store_->Delete(EntryKind::kModel, deleted), IsOk());
    }
    return true;
  }));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr(gone)));
}

TEST_F(ScrubberTest, StopsBetweenFiles) {
  const std::string a = Add("aaaa"), b = Add("bbbb");
  for (const std::string& id : {a, b}) ASSERT_THAT(WriteFile(PathOf(id), "????"), IsOk());
  int num_pauses = 0;
  EXPECT_FALSE(Pass([&](double) { return ++num_pauses < 2; }));
  EXPECT_EQ(problems_.size(), 1u);
}

TEST_F(ScrubberTest, ItsThreadFindsDamageAndEnds) {
  const std::string id = Add("content");
  ASSERT_THAT(WriteFile(PathOf(id), "?"), IsOk());
  std::promise<void> found;
  std::once_flag once;
  on_problem_ = [&] { std::call_once(once, [&] { found.set_value(); }); };
  {
    const Scrubber scrubber(store_.get(), 1e-3);
    found.get_future().wait();
  }
  { const Scrubber slow(store_.get(), 1e9); }  // ends at once although its pause is long
}

}  // namespace
}  // namespace pleat
