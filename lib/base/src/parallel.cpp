#include "pleat/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "pleat/base/processor_time.h"

namespace pleat {

void ParallelFor(int num_items, int num_threads, const std::function<void(int)>& body) {
  if (num_threads <= 0) num_threads = static_cast<int>(std::thread::hardware_concurrency());
  num_threads = std::clamp(num_threads, 1, std::max(1, num_items));
  if (num_threads == 1) {
    for (int item = 0; item < num_items; ++item) body(item);
    return;
  }
  // One shared counter instead of a fixed share for each thread: items differ in cost, and a thread
  // that is done early takes more of them.
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  auto work = [&] {
    for (int item = next++; item < num_items; item = next++) {
      try {
        body(item);
      } catch (...) {
        std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = num_items;  // hands out nothing more
      }
    }
  };
  std::vector<std::thread> threads;
  ProcessorTimeMeter* const meter = ProcessorTimeMeter::OfThisThread();
  for (int i = 1; i < num_threads; ++i) {
    threads.emplace_back([&work, meter] {
      const ProcessorTimeMeter::Scope counted(meter);
      work();
    });
  }
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace pleat
