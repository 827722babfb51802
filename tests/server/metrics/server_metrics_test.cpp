#include "pleat/metrics/server_metrics.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char kGetJob[] = "/pleat.v1.JobService/GetJob";

TEST(ServerMetricsTest, CallsAreCountedByMethodAndStatus) {
  ServerMetrics metrics;
  metrics.CallStarted(kGetJob);
  EXPECT_THAT(metrics.Text(),
              HasSubstr(R"(pleat_rpcs_open{method="/pleat.v1.JobService/GetJob"} 1)"));
  metrics.CallEnded(kGetJob, "OK", 3e-3);
  for (int i = 0; i < 2; ++i) {
    metrics.CallStarted(kGetJob);
    metrics.CallEnded(kGetJob, "NOT_FOUND", 60e-6);
  }
  const std::string text = metrics.Text();
  const std::string method = R"(method="/pleat.v1.JobService/GetJob")";
  EXPECT_THAT(text, HasSubstr("pleat_rpcs_open{" + method + "} 0"));
  EXPECT_THAT(text, HasSubstr("pleat_rpcs_total{" + method + R"(,status="OK"} 1)"));
  EXPECT_THAT(text, HasSubstr("pleat_rpcs_total{" + method + R"(,status="NOT_FOUND"} 2)"));
  EXPECT_THAT(text, HasSubstr("pleat_rpc_seconds_bucket{" + method + R"(,le="5e-05"} 0)"));
  EXPECT_THAT(text, HasSubstr("pleat_rpc_seconds_bucket{" + method + R"(,le="0.0001"} 2)"));
  EXPECT_THAT(text, HasSubstr("pleat_rpc_seconds_count{" + method + "} 3"));
}

TEST(ServerMetricsTest, NoClientMakesUpLabels) {
  ServerMetrics metrics;
  for (int i = 0; i < 100; ++i) {
    const std::string method = "/evil/" + std::to_string(i);
    metrics.CallStarted(method);
    metrics.CallEnded(method, "UNIMPLEMENTED", 1);
  }
  EXPECT_THAT(metrics.Text(), Not(HasSubstr("evil")));
  EXPECT_THAT(metrics.Text(), HasSubstr(R"({method="other",status="UNIMPLEMENTED"} 100)"));
}

TEST(ServerMetricsTest, StepsOfFramesAreMeasuredFrom50Microseconds) {
  ServerMetrics metrics;
  metrics.FrameStep("query", 40e-6);
  metrics.FrameStep("query", 60e-6);
  metrics.FrameStep("send", 2);
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr(R"(pleat_frame_seconds_bucket{step="query",le="5e-05"} 1)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_frame_seconds_count{step="query"} 2)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_frame_seconds_count{step="send"} 1)"));
}

TEST(ServerMetricsTest, StagesOfJobsAreMeasured) {
  ServerMetrics metrics;
  metrics.JobStage("learn", 20);
  EXPECT_THAT(metrics.Text(),
              HasSubstr(R"(pleat_job_stage_seconds_bucket{stage="learn",le="30"} 1)"));
}

TEST(ServerMetricsTest, GaugesAreReadWhenSomebodyAsks) {
  ServerMetrics metrics;
  double value = 1;
  metrics.AddGauge("pleat_jobs", "Jobs by state", {{"state", "queued"}}, [&] { return value; });
  metrics.AddGauge("pleat_jobs", "", {{"state", "running"}}, [] { return 7; });
  EXPECT_THAT(metrics.Text(), HasSubstr(R"(pleat_jobs{state="queued"} 1)"));
  value = 5;
  EXPECT_THAT(metrics.Text(), HasSubstr(R"(pleat_jobs{state="queued"} 5)"));
  EXPECT_THAT(metrics.Text(), HasSubstr(R"(pleat_jobs{state="running"} 7)"));
  EXPECT_THAT(metrics.Text(), HasSubstr("# HELP pleat_jobs Jobs by state"));
}

TEST(ServerMetricsTest, ManyThreadsCountTogether) {
  ServerMetrics metrics;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int call = 0; call < 250; ++call) {
        metrics.CallStarted(kGetJob);
        metrics.CallEnded(kGetJob, "OK", 1e-3);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(metrics.Text(), HasSubstr(R"(status="OK"} 1000)"));
}

TEST(ServerMetricsTest, StepsAndStagesAreSummed) {
  ServerMetrics metrics;
  metrics.FrameStep("query", 1e-3);
  metrics.JobStage("rig", 1);
  metrics.JobStage("rig", 2);
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr(R"(pleat_job_stage_seconds_count{stage="rig"} 2)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_job_stage_seconds_sum{stage="rig"} 3)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_frame_seconds_sum{step="query"} 0.001)"));
}

TEST(ServerMetricsTest, WhatIsCountedIsThereFromTheStart) {
  const std::string text = ServerMetrics().Text();
  EXPECT_THAT(text, HasSubstr(R"(pleat_frame_seconds_count{step="send"} 0)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_job_stage_seconds_count{stage="learn"} 0)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_refused_rpcs_total{limit="--memory-bytes"} 0)"));
}

TEST(ServerMetricsTest, CallsOfProjectsAndRefusalsAreCounted) {
  ServerMetrics metrics;
  metrics.CallOfProject("robots");
  metrics.CallOfProject("robots");
  metrics.CallOfProject("");  // not let in
  metrics.CallRefused("--project-bytes");
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr(R"(pleat_project_rpcs_total{project="robots"} 2)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_project_rpcs_total{project="none"} 1)"));
  EXPECT_THAT(text, HasSubstr(R"(pleat_refused_rpcs_total{limit="--project-bytes"} 1)"));
}

TEST(ServerMetricsTest, ASeriesHasAsManyValuesAsItsReaderGives) {
  ServerMetrics metrics;
  std::vector<ServerMetrics::Sample> samples = {{{{"project", "a"}}, 1}, {{{"project", "b"}}, 2}};
  metrics.AddSeries("pleat_x_total", "x", /*is_counter=*/true, [&] { return samples; });
  EXPECT_THAT(metrics.Text(), HasSubstr("# TYPE pleat_x_total counter"));
  EXPECT_THAT(metrics.Text(), HasSubstr(R"(pleat_x_total{project="b"} 2)"));
  samples.pop_back();
  EXPECT_THAT(metrics.Text(), Not(HasSubstr(R"(project="b")")));
}

TEST(ServerMetricsTest, AnAddressThatIsWrongIsSaid) {
  ServerMetrics metrics;
  EXPECT_THAT(metrics.Serve("nonsense"),
              HasStatus(absl::StatusCode::kUnavailable, HasSubstr("nonsense")));
}

}  // namespace
}  // namespace pleat
