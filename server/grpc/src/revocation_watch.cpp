#include "revocation_watch.h"

namespace pleat {

RevocationWatch::RevocationWatch(TokenRegistry* tokens, RunningCalls* calls,
                                 std::chrono::milliseconds period)
    : thread_([this, tokens, calls, period] {
        while (stop_.Pause(period)) {
          calls->CancelUnless([tokens](const std::string& id) { return tokens->IsStillGood(id); });
        }
      }) {}

RevocationWatch::~RevocationWatch() {
  stop_.Set();
  thread_.join();
}

}  // namespace pleat
