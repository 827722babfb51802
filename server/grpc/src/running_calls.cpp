#include "running_calls.h"

#include <utility>

namespace pleat {

RunningCalls::Entry::Entry(RunningCalls* calls, const std::string& token_id,
                           const grpc::ServerContextBase* context)
    : calls_(calls) {
  auto call = std::make_shared<Call>();
  call->context = context;
  std::lock_guard lock(calls_->mutex_);
  place_ = calls_->calls_.emplace(token_id, std::move(call));
}

RunningCalls::Entry::~Entry() {
  std::shared_ptr<Call> call;
  {
    std::lock_guard lock(calls_->mutex_);
    call = place_->second;
    calls_->calls_.erase(place_);
  }
  std::lock_guard lock(call->mutex);
  call->context = nullptr;
}

void RunningCalls::CancelUnless(const std::function<bool(const std::string& token_id)>& is_good) {
  Calls calls;
  {
    std::lock_guard lock(mutex_);
    calls = calls_;
  }
  for (auto it = calls.begin(); it != calls.end();) {
    const auto end = calls.upper_bound(it->first);
    const bool good = is_good(it->first);
    for (; it != end; ++it) {
      if (good) continue;
      std::lock_guard lock(it->second->mutex);
      if (it->second->context != nullptr) it->second->context->TryCancel();
    }
  }
}

}  // namespace pleat
