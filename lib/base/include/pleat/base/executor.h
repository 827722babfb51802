// A fixed number of threads for short pieces of work.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

#include "pleat/base/ring_queue.h"

namespace pleat {

// Tasks start in the order of Post, but flows take turns. The destructor runs what is still
// waiting, then joins. The queue is not bounded here: every stream has at most one task in it,
// every connection as many calls as the network layer allows.
class Executor {
 public:
  explicit Executor(int num_threads);  // 0 = one per core
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // The task must not throw. flow: whose task it is; a flow gets one task per round, however many
  // of it wait. 0: a flow of its own; such a task whose captures fit into std::function itself
  // (two pointers) is posted without an allocation.
  void Post(std::function<void()> task, uint64_t flow = 0);
  int num_threads() const { return static_cast<int>(threads_.size()); }

 private:
  using Task = std::function<void()>;
  struct Turn {
    Task task;  // null for a flow: the first of its tasks
    uint64_t flow = 0;
  };
  void Work();
  Task TakeNext();  // with mutex_, when there is one

  std::mutex mutex_;
  std::condition_variable changed_;
  RingQueue<Turn> turns_;                                   // guarded by mutex_
  std::unordered_map<uint64_t, std::deque<Task>> waiting_;  // per flow, not empty; by mutex_
  bool stopping_ = false;                                   // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace pleat
