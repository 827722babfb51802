// Signals change the whole process, so every case sends them to a child of its own.
#include "cli/interrupt.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "cli/exit_code.h"

namespace pleat {
namespace {

constexpr int kSetOnce = 41, kNotSet = 42;

// How a child that runs `body` ends, as waitpid says it.
int EndOfChild(const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    body();
    _exit(0);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

class InterruptTest : public testing::TestWithParam<int> {};

TEST_P(InterruptTest, TheFirstSignalSetsTheFlagAndTheChildGoesOn) {
  const int status = EndOfChild([] {
    InstallInterruptHandler();
    if (Interrupted()) _exit(1);
    raise(GetParam());
    _exit(Interrupted() ? kSetOnce : kNotSet);
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kSetOnce);
}

TEST_P(InterruptTest, TheSecondSignalEndsTheProcess) {
  const int status = EndOfChild([] {
    InstallInterruptHandler();
    raise(GetParam());
    raise(GetParam());
    _exit(kNotSet);
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), GetParam());
}

TEST_P(InterruptTest, VerbsThatOnlyLookEndAtOnceAsCancelled) {
  const int status = EndOfChild([] {
    ExitOnInterrupt();
    raise(GetParam());
    _exit(kNotSet);
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(ExitCode::kCancelled));
}

INSTANTIATE_TEST_SUITE_P(CtrlCAndTerm, InterruptTest, testing::Values(SIGINT, SIGTERM));

TEST(InterruptFlagTest, NothingIsInterruptedBeforeASignal) { EXPECT_FALSE(Interrupted()); }

}  // namespace
}  // namespace pleat
