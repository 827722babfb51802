// Fair scheduling without timers. For each kind of turn there is a round of its own (NextRound says
// which one is next) with two structures, guarded by mutex_:
//
//   turns      the round: a queue of places. A task without a flow is a place of its own; a flow
//              has exactly one place, however many of its tasks wait.
//   waiting    for each flow that has a place, its tasks in the order of Post; never empty.
//
// A worker takes the place at the front. If that place is a flow with more tasks behind the first,
// the place goes to the back of the round, so every other flow and every single task has its turn
// before this flow starts its next task. A flow without waiting tasks has neither a place nor a
// list, hence memory follows what waits and not how many flows there ever were. All steps cost
// O(1).
//
// The rounds are empty exactly when nothing waits. That makes notify_one() in Post() sufficient:
// each task wakes at most one worker, and a worker looks at them again before it sleeps, so a task
// that was posted while all workers were busy is found by the first one that becomes free.
//
// A task runs, and its captures are destroyed, outside of the mutex. So a task may call Post(), and
// a destructor in a capture may do so too. What a task must not do is wait for another task of the
// same executor: with every thread waiting, nobody is left to run what they wait for.
//
// Destruction drains: workers leave only when stopping_ is set and nothing waits. Tasks that
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

Executor::Executor(int num_threads) {
  for (Round& round : rounds_) round.turns = RingQueue<Turn>(std::vector<Turn>(kExpectedTurns));
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

void Executor::Post(std::function<void()> task, uint64_t flow, TurnKind kind) {
  {
    std::lock_guard lock(mutex_);
    Round& round = rounds_[static_cast<size_t>(kind)];
    if (flow == 0) {
      round.turns.PushBack() = {.task = std::move(task), .flow = 0};
    } else {
      std::deque<Task>& waiting = round.waiting[flow];
      waiting.push_back(std::move(task));
      if (waiting.size() == 1) round.turns.PushBack() = {.task = nullptr, .flow = flow};
    }
  }
  changed_.notify_one();
}

Executor::Round& Executor::NextRound() {
  Round& interactive = rounds_[static_cast<size_t>(TurnKind::kInteractive)];
  Round& bulk = rounds_[static_cast<size_t>(TurnKind::kBulk)];
  if (bulk.turns.empty()) return interactive;
  if (!interactive.turns.empty() && num_since_bulk_ < kInteractiveTurns) {
    ++num_since_bulk_;
    return interactive;
  }
  num_since_bulk_ = 0;
  return bulk;
}

Executor::Task Executor::TakeNext() {
  Round& round = NextRound();
  Turn turn = std::move(round.turns.front());
  round.turns.PopFront();
  if (turn.flow == 0) return std::move(turn.task);
  const auto waiting = round.waiting.find(turn.flow);
  Task task = std::move(waiting->second.front());
  waiting->second.pop_front();
  if (waiting->second.empty()) {
    round.waiting.erase(waiting);
  } else {
    round.turns.PushBack() = std::move(turn);
  }
  return task;
}

void Executor::Work() {
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !empty(); });
      if (empty()) return;
      task = TakeNext();
    }
    task();
  }
}

}  // namespace pleat
