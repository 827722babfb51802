#include "pleat/base/processor_time.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "pleat/base/parallel.h"

namespace pleat {
namespace {

// Works until `meter` has counted so many seconds for this thread.
void WorkFor(double seconds, ProcessorTimeMeter* meter, ProcessorTimeMeter::Scope* scope) {
  volatile double value = 0;
  while (meter->seconds() < seconds) {
    for (int i = 0; i < 1000; ++i) value = value + std::sqrt(static_cast<double>(i));
    scope->Update();
  }
}

TEST(ProcessorTimeTest, WorkIsCountedAndWaitingIsNot) {
  ProcessorTimeMeter meter;
  {
    ProcessorTimeMeter::Scope scope(&meter);
    EXPECT_EQ(ProcessorTimeMeter::OfThisThread(), &meter);
    WorkFor(.01, &meter, &scope);
  }
  EXPECT_EQ(ProcessorTimeMeter::OfThisThread(), nullptr);
  const double used = meter.seconds();
  EXPECT_GE(used, .01);
  ProcessorTimeMeter other;
  {
    ProcessorTimeMeter::Scope scope(&other);
    WorkFor(.005, &other, &scope);
  }
  EXPECT_EQ(meter.seconds(), used);  // after its scope nothing is counted
}

TEST(ProcessorTimeTest, OnlyTheInnermostScopeCounts) {
  ProcessorTimeMeter outer, inner;
  {
    ProcessorTimeMeter::Scope outer_scope(&outer);
    {
      ProcessorTimeMeter::Scope inner_scope(&inner);
      WorkFor(.02, &inner, &inner_scope);
    }
    EXPECT_EQ(ProcessorTimeMeter::OfThisThread(), &outer);
  }
  EXPECT_GE(inner.seconds(), .02);
  EXPECT_LT(outer.seconds(), .02);
}

TEST(ProcessorTimeTest, ThreadsOfParallelForCountForTheirCaller) {
  ProcessorTimeMeter meter;
  std::atomic<int> num_metered = 0;
  {
    ProcessorTimeMeter::Scope scope(&meter);
    ParallelFor(8, 4, [&](int) {
      if (ProcessorTimeMeter::OfThisThread() == &meter) ++num_metered;
      // Each item works for its own time, whichever thread has it.
      ProcessorTimeMeter own;
      {
        ProcessorTimeMeter::Scope own_scope(&own);
        WorkFor(.002, &own, &own_scope);
      }
      volatile double value = 0;
      for (int i = 0; i < 200'000; ++i) value = value + std::sqrt(static_cast<double>(i));
    });
  }
  EXPECT_EQ(num_metered, 8);
  EXPECT_GT(meter.seconds(), 0);
  ParallelFor(8, 4, [&](int) { EXPECT_EQ(ProcessorTimeMeter::OfThisThread(), nullptr); });
}

}  // namespace
}  // namespace pleat
