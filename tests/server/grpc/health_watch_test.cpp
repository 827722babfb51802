#include "health_watch.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <map>
#include <string>

namespace pleat {
namespace {

// What a health service was told, from any thread.
class ToldHealth final : public grpc::HealthCheckServiceInterface {
 public:
  void SetServingStatus(const std::string& service, bool serving) override {
    std::lock_guard lock(mutex_);
    serving_[service] = serving;
    changed_.notify_all();
  }
  void SetServingStatus(bool) override {}
  void Shutdown() override {}

  bool Serves(const std::string& service) {
    std::lock_guard lock(mutex_);
    return serving_.at(service);
  }
  void WaitUntil(const std::string& service, bool serving) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return serving_[service] == serving; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, bool> serving_;  // guarded by mutex_
};

class HealthWatchTest : public testing::Test {
 protected:
  HealthWatchTest() { spdlog::set_level(spdlog::level::off); }

  ToldHealth health_;
};

TEST_F(HealthWatchTest, WithoutAProbeEverythingServes) {
  const HealthWatch watch(&health_, nullptr);
  for (const char* name : {"pleat.v1.SequenceService", "pleat.v1.PoseService", kReadyName}) {
    EXPECT_TRUE(health_.Serves(name)) << name;
  }
}

TEST_F(HealthWatchTest, ADiskInTroubleIsNoticedAndSoIsItsEnd) {
  std::atomic<bool> works = false;
  const HealthWatch watch(
      &health_,
      [&] { return works ? absl::OkStatus() : absl::ResourceExhaustedError("the disk is full"); },
      std::chrono::milliseconds(1));
  EXPECT_FALSE(health_.Serves(kReadyName)) << "the first probe comes before the server serves";
  EXPECT_FALSE(health_.Serves("pleat.v1.JobService"));
  EXPECT_TRUE(health_.Serves("pleat.v1.PoseService")) << "poses need no disk";
  works = true;
  health_.WaitUntil(kReadyName, true);
  health_.WaitUntil("pleat.v1.SequenceService", true);
  works = false;
  health_.WaitUntil(kReadyName, false);
}

}  // namespace
}  // namespace pleat
