// Reads what is stored, again and again, to find damage before somebody needs the file.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "pleat/store/store.h"

namespace pleat {

class StopSignal;

// Verifies the files of `store` one after the other and spreads their reading evenly over a period.
// The verification puts damaged files in quarantine and tells the operator (Store::Verify); files
// that an entry names and that cannot be read are reported in every pass. `store` must outlive it.
class Scrubber {
 public:
  // Starts a thread of the lowest priority. period_seconds: the time of one pass, above 0.
  Scrubber(Store* store, double period_seconds);
  // Ends the thread, after the file that it reads.
  ~Scrubber();
  Scrubber(const Scrubber&) = delete;
  Scrubber& operator=(const Scrubber&) = delete;

  // Waits for so many seconds; false when it is time to stop.
  using Pause = std::function<bool(double seconds)>;
  // One pass over all files, with a pause before each. Returns false when a pause told it to stop.
  static bool RunPass(Store* store, double period_seconds, const Pause& pause);

 private:
  const std::unique_ptr<StopSignal> stop_;
  std::thread thread_;
};

}  // namespace pleat
