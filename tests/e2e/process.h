// Running the real programs: start, wait with a time limit, signal, read what they printed.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace pleat {

struct ProcessResult {
  int exit_code = -1;  // 128 + n when ended by signal n
  std::string out, err;
};

// One child process whose output goes to files in a folder of its own. The destructor kills it.
class Process {
 public:
  // environment: "NAME=value" entries on top of the parent's.
  Process(const std::vector<std::string>& command, const std::string& output_stem,
          const std::vector<std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool started() const { return pid_ > 0; }
  void Signal(int number) const;
  // Waits until it ends; kills it after `limit_seconds` (exit_code is then 137).
  ProcessResult Wait(double limit_seconds = 120);
  // True as soon as `text` stands in its output or errors; false when it ended or time is up.
  bool WaitForText(const std::string& text, double limit_seconds = 20);
  std::string out() const;
  std::string err() const;

 private:
  bool Poll();  // true when it has ended

  pid_t pid_ = -1;
  bool ended_ = false;
  int exit_code_ = -1;
  std::string out_path_, err_path_;
};

// build/bin/<name> of this build.
std::string ProgramPath(const std::string& name);

}  // namespace pleat
