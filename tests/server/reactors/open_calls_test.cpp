#include "pleat/reactors/open_calls.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace pleat {
namespace {

const auto kPast = std::chrono::steady_clock::time_point();

TEST(OpenCalls, WaitsForNobodyWhenNoCallIsOpen) {
  OpenCalls calls;
  EXPECT_TRUE(calls.WaitUntilNone(kPast));
  calls.WaitUntilNone();
}

TEST(OpenCalls, TheDeadlineComesFirstWhileACallIsOpen) {
  OpenCalls calls;
  std::optional<OpenCalls::Entry> first(&calls), second(&calls);
  EXPECT_FALSE(calls.WaitUntilNone(kPast));
  first.reset();
  EXPECT_FALSE(calls.WaitUntilNone(kPast));
  second.reset();
  EXPECT_TRUE(calls.WaitUntilNone(kPast));
}

TEST(OpenCalls, TheLastOneWakesAllWhoWait) {
  OpenCalls calls;
  std::optional<OpenCalls::Entry> entry(&calls);
  std::vector<std::thread> waiting;
  for (int i = 0; i < 2; ++i) waiting.emplace_back([&] { calls.WaitUntilNone(); });
  entry.reset();
  for (std::thread& thread : waiting) thread.join();
}

// Sanitizers see whether the last entry still touches what the waiting thread has destroyed.
TEST(OpenCalls, MayBeDestroyedAsSoonAsNoCallIsOpen) {
  for (int i = 0; i < 200; ++i) {
    auto calls = std::make_unique<OpenCalls>();
    auto entry = std::make_unique<OpenCalls::Entry>(calls.get());
    std::thread ending([&] { entry.reset(); });
    calls->WaitUntilNone();
    calls.reset();
    ending.join();
  }
}

}  // namespace
}  // namespace pleat
