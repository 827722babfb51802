// A place in which a thread waits until a test lets it go on.
#pragma once

#include <latch>

namespace pleat {

// For one thread that passes, once.
class Checkpoint {
 public:
  // The thread has come here, and waits for Release.
  void Pass() {
    reached_.count_down();
    released_.wait();
  }
  void WaitUntilReached() { reached_.wait(); }
  void Release() { released_.count_down(); }

 private:
  std::latch reached_{1}, released_{1};
};

}  // namespace pleat
