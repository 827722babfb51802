#include "trace_context.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

// The example of the standard, section 3.2.4.
constexpr char kExample[] = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

TEST(TraceContextTest, TakesTheTraceOfTheStandardsExample) {
  EXPECT_EQ(TraceIdOf(kExample), "4bf92f3577b34da6a3ce929d0e0e4736");
}

TEST(TraceContextTest, WhatIsNotAsTheStandardSaysIsNoTrace) {
  const std::string good = kExample;
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_EQ(TraceIdOf(good.substr(0, length)), "") << length;
  }
  EXPECT_EQ(TraceIdOf(good + "0"), "");
  EXPECT_EQ(TraceIdOf("01" + good.substr(2)), "") << "another version";
  EXPECT_EQ(TraceIdOf("00-" + std::string(32, '0') + good.substr(35)), "");
  EXPECT_EQ(TraceIdOf(good.substr(0, 36) + std::string(16, '0') + "-01"), "");
  std::string upper = good;
  upper[4] = 'B';
  EXPECT_EQ(TraceIdOf(upper), "");
  std::string dash = good;
  dash[35] = '_';
  EXPECT_EQ(TraceIdOf(dash), "");
}

}  // namespace
}  // namespace pleat
