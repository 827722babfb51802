#include "revocation_watch.h"

namespace pleat {

RevocationWatch::RevocationWatch(TokenRegistry* tokens, RunningCalls* calls,
                                 std::chrono::milliseconds period)
    : tokens_(tokens), calls_(calls), period_(period), thread_([this] { Run(); }) {}

RevocationWatch::~RevocationWatch() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RevocationWatch::Run() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, period_, [this] { return stop_; })) {
    calls_->CancelUnless([this](const std::string& id) { return tokens_->IsStillGood(id); });
  }
}

}  // namespace pleat
