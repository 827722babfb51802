// A fixed number of threads that run short pieces of work, in a fair order.
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

// Runs tasks on its own threads. Tasks start in the order in which they were posted, except that
// flows take turns: a flow with a thousand waiting tasks delays another flow by one task per round.
// The order concerns starts only; two tasks of one flow may run at the same time.
//
// Post() may be called from any thread, from a task too, as long as the executor is not being
// destroyed by another thread meanwhile. The queue is not bounded here. The callers bound it: every
// stream has at most one task in it, every connection as many calls as the network layer allows.
class Executor {
 public:
  // 0 or less means one thread per core.
  explicit Executor(int num_threads);
  // Runs everything that is still waiting, then joins the threads. A task must not destroy its own
  // executor: it would wait for itself.
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // Queues `task`, which must not throw. `flow` says whose task it is: a flow gets one task per
  // round, however many of its tasks wait. The flow 0 stands for a flow of the task's own; posting
  // to it allocates nothing when the captures of the task fit into std::function itself (two
  // pointers) and no more than 256 turns wait, or as many have waited before.
  void Post(std::function<void()> task, uint64_t flow = 0);
  int num_threads() const { return static_cast<int>(threads_.size()); }

 private:
  using Task = std::function<void()>;
  // A place in the round: either one task without a flow, or the first waiting task of `flow`.
  struct Turn {
    Task task;  // null when `flow` is set
    uint64_t flow = 0;
  };
  void Work();
  // Call with mutex_ held and turns_ not empty.
  Task TakeNext();

  std::mutex mutex_;
  std::condition_variable changed_;
  RingQueue<Turn> turns_;                                   // guarded by mutex_
  std::unordered_map<uint64_t, std::deque<Task>> waiting_;  // guarded by mutex_, never empty lists
  bool stopping_ = false;                                   // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace pleat
