// A fixed number of threads for short pieces of work.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace pleat {

// Tasks start in the order of Post. The destructor runs what is still waiting, then joins. The
// queue is not bounded here: every stream has at most one task in it.
class Executor {
 public:
  explicit Executor(int num_threads);  // 0 = one per core
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  void Post(std::function<void()> task);  // the task must not throw
  int num_threads() const { return static_cast<int>(threads_.size()); }

 private:
  void Work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // guarded by mutex_
  bool stopping_ = false;                    // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace pleat
