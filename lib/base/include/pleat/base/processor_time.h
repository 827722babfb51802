// How much processor time the threads of one piece of work have used.
#pragma once

#include <atomic>
#include <cstdint>

namespace pleat {

// Adds up the processor time of threads. A thread that works for a meter says so with a Scope, and
// ParallelFor counts the threads that it makes for the meter of its caller. Thread-safe.
class ProcessorTimeMeter {
 public:
  // Counts the time of this thread from now on until it is destroyed. Scopes of one thread are
  // nested, and only the innermost counts.
  class Scope {
   public:
    explicit Scope(ProcessorTimeMeter* meter);  // null: counts for nobody
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

    // Adds what this thread has used since the begin or the last call, so that seconds() is up to
    // date. It does nothing in another thread, and while a scope inside of it lives.
    void Update();

   private:
    ProcessorTimeMeter* const meter_;
    Scope* const outer_;
    int64_t counted_ns_ = 0;  // of this thread: the time up to which somebody has counted
  };

  // The meter that this thread works for; null: none.
  static ProcessorTimeMeter* OfThisThread();

  // The time of all scopes that have ended, and of others up to their last Update.
  double seconds() const { return 1e-9 * static_cast<double>(used_ns_.load()); }

 private:
  std::atomic<int64_t> used_ns_ = 0;
};

}  // namespace pleat
