// Running the real programs: start, wait with a time limit, signal, read what they printed.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace pleat {

struct ProcessResult {
  int exit_code = -1;  // 128 + n when ended by signal n
  std::string out, err;
};

// One child process. A thread of its own takes what it prints and notices its end, so that nobody
// has to ask again and again. The destructor kills it.
class Process {
 public:
  // environment: "NAME=value" entries on top of the parent's.
  explicit Process(const std::vector<std::string>& command,
                   const std::vector<std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Signal(int number);
  // Waits until it ends; kills it after `limit_seconds` (exit_code is then 137).
  ProcessResult Wait(double limit_seconds = 120);
  // True as soon as `text` stands in its output or errors; false when it ended or time is up.
  bool WaitForText(const std::string& text, double limit_seconds = 20);
  std::string out() const;
  std::string err() const;

 private:
  // Until both ends of the child's output are closed and it has ended.
  void Watch(int out_fd, int err_fd);

  pid_t pid_ = -1;
  mutable std::mutex mutex_;  // guards the next three
  std::string out_, err_;
  bool ended_ = false;
  int exit_code_ = -1;
  std::condition_variable changed_;
  std::thread watcher_;  // last: it uses all of the above
};

// build/bin/<name> of this build.
std::string ProgramPath(const std::string& name);

}  // namespace pleat
