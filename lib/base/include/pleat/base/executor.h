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

// Somebody waits for an interactive task now; bulk tasks are parts of something long. When both
// wait, there are kInteractiveTurns of the first kind for one of the second: neither can starve the
// other.
enum class TurnKind : uint8_t { kInteractive, kBulk };
inline constexpr int kInteractiveTurns = 4;

// Runs tasks on its own threads. Tasks of one kind start in the order in which they were posted,
// except that flows take turns: a flow with a thousand waiting tasks delays another flow by one
// task per round. The order concerns starts only; two tasks of one flow may run at the same time.
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
  // pointers) and no more than 256 turns of the kind wait, or as many have waited before. All tasks
  // of a flow are of one kind.
  void Post(std::function<void()> task, uint64_t flow = 0, TurnKind kind = TurnKind::kInteractive);
  int num_threads() const { return static_cast<int>(threads_.size()); }

 private:
  using Task = std::function<void()>;
  // A place in the round: either one task without a flow, or the first waiting task of `flow`.
  struct Turn {
    Task task;  // null when `flow` is set
    uint64_t flow = 0;
  };
  // The round of one kind.
  struct Round {
    RingQueue<Turn> turns;
    std::unordered_map<uint64_t, std::deque<Task>> waiting;  // never empty lists
  };
  void Work();
  // Call these with mutex_ held; a task is there to be taken.
  bool empty() const { return rounds_[0].turns.empty() && rounds_[1].turns.empty(); }
  Round& NextRound();
  Task TakeNext();

  std::mutex mutex_;
  std::condition_variable changed_;
  Round rounds_[2];         // by TurnKind; guarded by mutex_
  int num_since_bulk_ = 0;  // interactive turns while bulk waited; guarded by mutex_
  bool stopping_ = false;   // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace pleat
