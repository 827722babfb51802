#include "e2e/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

extern char** environ;

namespace pleat {
namespace {

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

std::chrono::duration<double> Seconds(double seconds) {
  return std::chrono::duration<double>(seconds);
}

// What `fd` has now, at the end of *text; false at its end.
bool ReadSome(int fd, std::mutex& mutex, std::string* text) {
  char buffer[4096];
  const ssize_t count = read(fd, buffer, sizeof buffer);
  if (count < 0 && errno == EINTR) return true;
  if (count <= 0) return false;
  std::lock_guard lock(mutex);
  text->append(buffer, static_cast<size_t>(count));
  return true;
}

}  // namespace

Process::Process(const std::vector<std::string>& command,
                 const std::vector<std::string>& environment) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  std::vector<std::string> variables = environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (text.rfind("PLEAT_", 0) != 0) variables.push_back(text);  // tests choose these themselves
  }
  if (posix_spawn(&pid_, command[0].c_str(), &actions, nullptr, Pointers(command).data(),
                  Pointers(variables).data()) != 0) {
    pid_ = -1;
  }
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);
  watcher_ = std::thread([this, out_fd = out[0], err_fd = err[0]] { Watch(out_fd, err_fd); });
}

Process::~Process() {
  Signal(SIGKILL);
  if (watcher_.joinable()) watcher_.join();
}

void Process::Watch(int out_fd, int err_fd) {
  pollfd ends[] = {{out_fd, POLLIN, 0}, {err_fd, POLLIN, 0}};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    if (poll(ends, 2, -1) < 0) continue;
    for (pollfd& end : ends) {
      if (end.revents == 0 || ReadSome(end.fd, mutex_, end.fd == out_fd ? &out_ : &err_)) continue;
      close(end.fd);
      end.fd = -1;  // which poll leaves out
    }
    changed_.notify_all();
  }
  // Its number stays its own until it has been waited for under the lock: see Signal.
  siginfo_t unused;
  while (pid_ > 0 && waitid(P_PID, static_cast<id_t>(pid_), &unused, WEXITED | WNOWAIT) != 0) {
  }
  std::lock_guard lock(mutex_);
  int status = 0;
  if (pid_ > 0 && waitpid(pid_, &status, 0) == pid_) {
    exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  ended_ = true;
  changed_.notify_all();
}

void Process::Signal(int number) {
  std::lock_guard lock(mutex_);
  if (pid_ > 0 && !ended_) kill(pid_, number);
}

ProcessResult Process::Wait(double limit_seconds) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, Seconds(limit_seconds), [this] { return ended_; })) {
    kill(pid_, SIGKILL);
    changed_.wait(lock, [this] { return ended_; });
  }
  return {exit_code_, out_, err_};
}

bool Process::WaitForText(const std::string& text, double limit_seconds) {
  std::unique_lock lock(mutex_);
  const auto is_there = [&] { return (out_ + err_).find(text) != std::string::npos; };
  changed_.wait_for(lock, Seconds(limit_seconds), [&] { return ended_ || is_there(); });
  return is_there();
}

std::string Process::out() const {
  std::lock_guard lock(mutex_);
  return out_;
}

std::string Process::err() const {
  std::lock_guard lock(mutex_);
  return err_;
}

std::string ProgramPath(const std::string& name) { return std::string(PLEAT_BIN_DIR "/") + name; }

}  // namespace pleat
