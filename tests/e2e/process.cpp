#include "e2e/process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace pleat {
namespace {

std::string ReadAll(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

using Clock = std::chrono::steady_clock;

Clock::time_point After(double seconds) {
  return Clock::now() + std::chrono::milliseconds(static_cast<long>(seconds * 1000));
}

constexpr auto kPollInterval = std::chrono::milliseconds(10);

}  // namespace

Process::Process(const std::vector<std::string>& command, const std::string& output_stem,
                 const std::vector<std::string>& environment)
    : out_path_(output_stem + ".out"), err_path_(output_stem + ".err") {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_path_.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_path_.c_str(), flags, 0600);
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
}

Process::~Process() {
  if (!started() || Poll()) return;
  Signal(SIGKILL);
  while (!Poll()) std::this_thread::sleep_for(kPollInterval);
}

void Process::Signal(int number) const {
  if (started() && !ended_) kill(pid_, number);
}

bool Process::Poll() {
  if (ended_) return true;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  ended_ = true;
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return true;
}

ProcessResult Process::Wait(double limit_seconds) {
  if (!started()) return {};
  for (const auto limit = After(limit_seconds); !Poll();) {
    if (Clock::now() > limit) Signal(SIGKILL);
    std::this_thread::sleep_for(kPollInterval);
  }
  return {exit_code_, out(), err()};
}

bool Process::WaitForText(const std::string& text, double limit_seconds) {
  for (const auto limit = After(limit_seconds); started() && Clock::now() < limit;) {
    const bool ended = Poll();
    if ((out() + err()).find(text) != std::string::npos) return true;
    if (ended) return false;
    std::this_thread::sleep_for(kPollInterval);
  }
  return false;
}

std::string Process::out() const { return ReadAll(out_path_); }
std::string Process::err() const { return ReadAll(err_path_); }

std::string ProgramPath(const std::string& name) { return std::string(PLEAT_BIN_DIR "/") + name; }

}  // namespace pleat
