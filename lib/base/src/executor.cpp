// Fair scheduling without priorities or timers. There are two structures, both guarded by mutex_:
//
//   turns_     the round: a queue of places. A task without a flow is a place of its own; a flow
//              has exactly one place, however many of its tasks wait.
//   waiting_   for each flow that has a place, its tasks in the order of Post; never empty.
//
// A worker takes the place at the front. If that place is a flow with more tasks behind the first,
// the place goes to the back of the round, so every other flow and every single task has its turn
// before this flow starts its next task. A flow without waiting tasks has neither a place nor a
// list, hence memory follows what waits and not how many flows there ever were. All steps cost
// O(1).
//
// turns_ is empty exactly when nothing waits. That makes notify_one() in Post() sufficient: each
// task wakes at most one worker, and a worker looks at turns_ again before it sleeps, so a task
// that was posted while all workers were busy is found by the first one that becomes free.
//
// A task runs, and its captures are destroyed, outside of the mutex. So a task may call Post(), and
// a destructor in a capture may do so too. What a task must not do is wait for another task of the
// same executor: with every thread waiting, nobody is left to run what they wait for.
//
// Destruction drains: workers leave only when stopping_ is set and turns_ is empty. Tasks that
// running tasks post during the drain still run, since the worker that posted them looks again.
// Nothing is dropped, because a dropped task may be the one that answers a client or releases a
// lock. The price is that the destructor takes as long as the work that is left.

#include "pleat/base/executor.h"

#include <algorithm>
#include <utility>

namespace pleat {
namespace {

// More streams than a server plays at once. How many of them wait at the same moment depends on
// the threads, so a queue that grew as needed would allocate at moments that nobody can foresee.
constexpr size_t kExpectedTurns = 256;

}  // namespace

Executor::Executor(int num_threads) : turns_(std::vector<Turn>(kExpectedTurns)) {
  if (num_threads <= 0) num_threads = static_cast<int>(std::thread::hardware_concurrency());
  for (int i = 0; i < std::max(1, num_threads); ++i) threads_.emplace_back([this] { Work(); });
}

Executor::~Executor() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Executor::Post(std::function<void()> task, uint64_t flow) {
  {
    std::lock_guard lock(mutex_);
    if (flow == 0) {
      turns_.PushBack() = {.task = std::move(task), .flow = 0};
    } else {
      std::deque<Task>& waiting = waiting_[flow];
      waiting.push_back(std::move(task));
      if (waiting.size() == 1) turns_.PushBack() = {.task = nullptr, .flow = flow};
    }
  }
  changed_.notify_one();
}

Executor::Task Executor::TakeNext() {
  Turn turn = std::move(turns_.front());
  turns_.PopFront();
  if (turn.flow == 0) return std::move(turn.task);
  const auto waiting = waiting_.find(turn.flow);
  Task task = std::move(waiting->second.front());
  waiting->second.pop_front();
  if (waiting->second.empty()) {
    waiting_.erase(waiting);
  } else {
    turns_.PushBack() = std::move(turn);
  }
  return task;
}

void Executor::Work() {
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !turns_.empty(); });
      if (turns_.empty()) return;
      task = TakeNext();
    }
    task();
  }
}

}  // namespace pleat
