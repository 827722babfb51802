#include "cli/load/load_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(LoadReportTest, PercentilesAreValuesThatOccurred) {
  std::vector<double> values;
  for (int i = 1; i <= 1000; ++i) values.push_back(i);
  EXPECT_EQ(Percentile(values, 0), 1);
  EXPECT_EQ(Percentile(values, 50), 500);
  EXPECT_EQ(Percentile(values, 99), 990);
  EXPECT_EQ(Percentile(values, 99.9), 999);
  EXPECT_EQ(Percentile(values, 100), 1000);
  EXPECT_EQ(Percentile({7}, 99.9), 7);
  EXPECT_EQ(Percentile({1, 2}, 50), 1);
  EXPECT_EQ(Percentile({1, 2}, 51), 2);
}

TEST(LoadReportTest, FixedArrivalsAreEquallySpacedAndShiftedPerClient) {
  const LoadOptions options{.num_clients = 4, .rate_fps = 20, .seconds = 2};
  const std::vector<double> first = SendTimes(options, 0), third = SendTimes(options, 2);
  ASSERT_EQ(first.size(), 40u);
  EXPECT_EQ(first[0], 0);
  EXPECT_NEAR(first[39], 39 / 20.0, 1e-9);
  EXPECT_NEAR(third[0], .025, 1e-12);
  EXPECT_NEAR(third[1] - third[0], .05, 1e-12);
}

TEST(LoadReportTest, PoissonArrivalsHaveTheRateAndExponentialGaps) {
  const LoadOptions options{
      .num_clients = 1, .rate_fps = 100, .seconds = 200, .arrivals = Arrivals::kPoisson, .seed = 3};
  const std::vector<double> times = SendTimes(options, 0);
  EXPECT_NEAR(static_cast<double>(times.size()), 20'000, 600);  // 4 standard deviations
  int num_long = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    ASSERT_GT(times[i], times[i - 1]);
    num_long += times[i] - times[i - 1] > .02;  // twice the mean: e^-2 of them
  }
  EXPECT_NEAR(num_long / static_cast<double>(times.size()), .1353, .012);
  EXPECT_NE(SendTimes(options, 1), times);
  EXPECT_EQ(SendTimes(options, 0), times);
}

LoadReport MakeReport() {
  LoadReport report;
  report.model_id = "abc";
  report.encoding = "delta";
  report.num_vertices = 10'000;
  report.options.num_clients = 2;
  report.options.seconds = 2;
  report.result.clients = {{{.sent_s = 0,
                             .latency_ms = 3,
                             .times = {.queue_us = 100, .evaluate_us = 700, .encode_us = 300},
                             .num_bytes = 1000},
                            {.sent_s = .5,
                             .latency_ms = 1,
                             .times = {.queue_us = 0, .evaluate_us = 500, .encode_us = 200},
                             .num_bytes = 3000}},
                           {{.sent_s = 0,
                             .latency_ms = 2,
                             .times = {.queue_us = 50, .evaluate_us = 600, .encode_us = 250},
                             .num_bytes = 2000}}};
  report.result.num_intended = 4;
  report.result.num_sent = 4;
  report.result.num_superseded = 1;
  report.result.seconds = 2;
  report.result.server_cpu_seconds = .006;
  report.draco = {.encode_ms = .5, .num_frames = 60};
  report.Summarize();
  return report;
}

TEST(LoadReportTest, SummarizesAllClientsTogether) {
  const LoadReport report = MakeReport();
  EXPECT_EQ(report.num_frames, 3);
  EXPECT_THAT(report.latency_ms, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(report.queue_ms, testing::ElementsAre(0, .05, .1));
  EXPECT_THAT(report.achieved_fps, testing::ElementsAre(1, .5));
  EXPECT_EQ(report.bytes_per_frame, 2000);
  const nlohmann::ordered_json json = LoadReportJson(report);
  EXPECT_EQ(json["latency_ms"]["p50"], 2);
  EXPECT_NEAR(json["server_ms"]["evaluate"]["max"].get<double>(), .7, 1e-12);
  EXPECT_DOUBLE_EQ(json["frames_per_cpu_second"], 500);
  EXPECT_DOUBLE_EQ(json["draco"]["frames_per_cpu_second"], 2000);
  EXPECT_DOUBLE_EQ(json["share_of_draco"], .25);
  EXPECT_EQ(json["achieved_fps"]["lowest"], .5);
  EXPECT_EQ(json["num_superseded"], 1);
}

TEST(LoadReportTest, PrintsAndPlots) {
  const LoadReport report = MakeReport();
  std::ostringstream out;
  PrintLoadReport(report, out);
  EXPECT_THAT(out.str(), HasSubstr("3 of 4 poses"));
  EXPECT_THAT(out.str(), HasSubstr("1 superseded"));
  EXPECT_THAT(out.str(), HasSubstr("500 frames per second and core"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string png, PlotLoad(report, "load.png"));
  EXPECT_THAT(png, HasSubstr("PNG"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string svg, PlotLoad(report, "load.svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
}

}  // namespace
}  // namespace pleat
