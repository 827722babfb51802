// pleatd as a child process, for tests of the program.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "support/temporary_folder.h"

namespace pleat {

// Its standard output and its log are read together.
class Daemon {
 public:
  explicit Daemon(const std::vector<std::string>& flags) {
    int out[2];
    if (pipe(out) != 0) abort();
    child_ = fork();
    if (child_ == 0) {
      dup2(out[1], STDOUT_FILENO);
      dup2(out[1], STDERR_FILENO);
      close(out[0]);
      std::vector<std::string> words{PLEATD_PATH};
      words.insert(words.end(), flags.begin(), flags.end());
      std::vector<char*> argv;
      for (std::string& word : words) argv.push_back(word.data());
      argv.push_back(nullptr);
      execv(PLEATD_PATH, argv.data());
      _exit(127);
    }
    close(out[1]);
    output_fd_ = out[0];
  }
  ~Daemon() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(output_fd_);
  }

  // The address that it says it listens on; empty when it ended before.
  std::string WaitForAddress() {
    const std::string mark = "listening on ";
    while (ReadMore()) {
      const size_t start = output_.find(mark);
      if (start == std::string::npos) continue;
      const size_t end = output_.find('\n', start);
      if (end != std::string::npos) {
        return output_.substr(start + mark.size(), end - start - mark.size());
      }
    }
    return "";
  }
  // Reads until it has said `words`; false when it ended before.
  bool WaitForOutput(const std::string& words) {
    while (output_.find(words) == std::string::npos) {
      if (!ReadMore()) return false;
    }
    return true;
  }
  void Signal(int number) { kill(child_, number); }
  // The most memory that it has had, in bytes.
  uint64_t PeakBytes() const {
    std::ifstream status(absl::StrCat("/proc/", child_, "/status"));
    for (std::string word; status >> word;) {
      uint64_t kilobytes = 0;
      if (word == "VmHWM:" && status >> kilobytes) return kilobytes << 10;
    }
    return 0;
  }
  // Waits for the end; exit code, or -signal.
  int Wait() {
    while (ReadMore()) {
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  const std::string& output() const { return output_; }

 private:
  bool ReadMore() {
    char buffer[4096];
    const ssize_t count = read(output_fd_, buffer, sizeof buffer);
    if (count > 0) output_.append(buffer, static_cast<size_t>(count));
    return count > 0;
  }

  pid_t child_ = -1;
  int output_fd_ = -1;
  std::string output_;
};

// Those of most tests: a free port, and jobs that no other load can hold up.
inline std::vector<std::string> DaemonFlags(const TemporaryFolder& folder) {
  return {"--data-dir",      folder.path(), "--listen",       "127.0.0.1:0",
          "--reserve-bytes", "1MB",         "--job-priority", "normal"};
}

}  // namespace pleat
