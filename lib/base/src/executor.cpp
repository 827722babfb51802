#include "pleat/base/executor.h"

#include <algorithm>
#include <utility>

namespace pleat {

Executor::Executor(int num_threads) {
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
