#include "cli/show/report_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pleat {
namespace {

TEST(ReportJson, ErrorsHaveExactlyTheFieldsOfTheSchema) {
  ErrorSummary error;
  error.mean_percent = 1;
  error.rms_percent = 2;
  error.p95_percent = 3;
  error.max_percent = 4;
  error.mean_mm = 5;
  EXPECT_EQ(ErrorJson(error).dump(),
            R"({"mean_percent":1.0,"rms_percent":2.0,"p95_percent":3.0,"max_percent":4.0,)"
            R"("mean_mm":5.0})");
}

TEST(ReportJson, MotionThatWasNotMeasuredIsNull) {
  ErrorSummary error;
  error.motion_mean_mm = 2;
  error.jitter_mm = 3;
  EXPECT_TRUE(MotionJson(error)["mean_mm"].is_null());
  EXPECT_TRUE(MotionJson(error)["jitter_mm"].is_null());
  error.num_motion_frames = 5;
  EXPECT_EQ(MotionJson(error)["mean_mm"], 2.0);
  EXPECT_TRUE(MotionJson(error)["truth_jitter_mm"].is_null());
  error.num_jitter_frames = 4;
  EXPECT_EQ(MotionJson(error)["jitter_mm"], 3.0);
}

TEST(ReportJson, ValidationSaysWhyALearnerWasChosen) {
  EXPECT_TRUE(ValidationJson({}).is_null());
  EXPECT_EQ(ValidationJson({12, {{"gp", .25}, {"regional", .5}}}).dump(),
            R"({"num_held_out_frames":12,"mean_percent":{"gp":0.25,"regional":0.5}})");
}

TEST(ReportJson, OptionsKeepTheirTypes) {
  const nlohmann::ordered_json json = OptionsJson(TrainOptions::Paper());
  EXPECT_EQ(json["learner"], "sgplvm");
  EXPECT_TRUE(json["iterations"].is_number_integer());
  EXPECT_EQ(json["resolution_percent"], 5.0);
  size_t count = 0;
  const TrainOptions options;
  VisitTrainOptions(options, [&count](const char*, const auto&) { ++count; });
  EXPECT_EQ(json.size(), count);
}

TEST(ReportJson, EvaluationHasTheFieldsOfTheSchema) {
  EvaluateReport report;
  report.protocol = "blocks10";
  report.learner = "gp";
  report.diagonal_m = 2;
  report.baselines["zero"].mean_percent = 1.5;
  report.learners["gp"].mean_percent = .5;
  report.seconds = {{"read", 1}, {"learn", 2}};
  const nlohmann::ordered_json json = EvaluateReportJson(report);
  EXPECT_EQ(json["schema"], "pleat.evaluate/1");
  EXPECT_EQ(json["protocol"], "blocks10");
  EXPECT_EQ(json["baselines"]["zero"]["mean_percent"], 1.5);
  EXPECT_EQ(json["learners"]["gp"]["mean_percent"], .5);
  EXPECT_EQ(json["seconds"]["learn"], 2.0);
  EXPECT_TRUE(json["motion"]["learners"]["gp"]["mean_mm"].is_null());
  for (const char* field : {"diagonal_m", "learner", "skinned", "hybrid", "validation"}) {
    EXPECT_TRUE(json.contains(field)) << field;
  }
}

}  // namespace
}  // namespace pleat
