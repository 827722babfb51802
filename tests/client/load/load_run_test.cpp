// The schedule of a load. The load itself is tested against a server in tests/e2e/bench_test.cpp.
#include "cli/load/load_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

LoadOptions Options(Arrivals arrivals, int num_clients = 1, double seconds = 10) {
  LoadOptions options;
  options.arrivals = arrivals;
  options.num_clients = num_clients;
  options.rate_fps = 30;
  options.seconds = seconds;
  return options;
}

TEST(LoadRunTest, FixedArrivalsAreAtEqualDistances) {
  const std::vector<double> times = SendTimes(Options(Arrivals::kFixed), 0);
  ASSERT_EQ(times.size(), 300u);
  EXPECT_EQ(times[0], 0);
  for (size_t k = 1; k < times.size(); ++k) {
    EXPECT_NEAR(times[k] - times[k - 1], 1. / 30, 1e-12);
  }
}

TEST(LoadRunTest, ClientsShareThePeriodEvenly) {
  const LoadOptions options = Options(Arrivals::kFixed, 4, 1);
  for (int client = 0; client < 4; ++client) {
    EXPECT_DOUBLE_EQ(SendTimes(options, client)[0], client / 120.);
    EXPECT_EQ(SendTimes(options, client).size(), 30u);
  }
}

// 0.1 is no binary fraction: 30 of them must not become 29.
TEST(LoadRunTest, RoundingLosesNoPose) {
  LoadOptions options = Options(Arrivals::kFixed, 1, .1);
  options.rate_fps = 300;
  EXPECT_EQ(SendTimes(options, 0).size(), 30u);
}

TEST(LoadRunTest, PoissonArrivalsHaveTheRateAndTheSpread) {
  const std::vector<double> times = SendTimes(Options(Arrivals::kPoisson, 1, 1000), 0);
  // 30,000 expected, three standard deviations of a Poisson count are 520.
  EXPECT_NEAR(static_cast<double>(times.size()), 30'000, 520);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_LT(times.back(), 1000);
  double sum = 0, squares = 0;
  for (size_t k = 1; k < times.size(); ++k) {
    const double gap = times[k] - times[k - 1];
    sum += gap;
    squares += gap * gap;
  }
  const double mean = sum / static_cast<double>(times.size() - 1);
  const double deviation = std::sqrt(squares / static_cast<double>(times.size() - 1) - mean * mean);
  EXPECT_NEAR(deviation / mean, 1, .05);  // of an exponential distribution
}

TEST(LoadRunTest, SeedsAndClientsDecidePoissonArrivals) {
  LoadOptions options = Options(Arrivals::kPoisson);
  const std::vector<double> times = SendTimes(options, 0);
  EXPECT_EQ(SendTimes(options, 0), times);
  EXPECT_NE(SendTimes(options, 1), times);
  options.seed = 2;
  EXPECT_NE(SendTimes(options, 0), times);
}

TEST(LoadRunTest, AClosedLoopHasNoSchedule) {
  EXPECT_TRUE(SendTimes(Options(Arrivals::kClosed), 0).empty());
}

}  // namespace
}  // namespace pleat
