// What the reports of `train` and `evaluate` promise, field by field (client/README.md).
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace pleat {

inline void ExpectErrorFields(const nlohmann::json& error, const std::string& where) {
  ASSERT_TRUE(error.is_object()) << where;
  for (const char* field :
       {"mean_percent", "rms_percent", "p95_percent", "max_percent", "mean_mm"}) {
    ASSERT_TRUE(error.contains(field)) << where << "." << field;
    ASSERT_TRUE(error[field].is_number()) << where << "." << field;
    EXPECT_GE(error[field].get<double>(), 0) << where << "." << field;
  }
  EXPECT_EQ(error.size(), 5u) << where;
  EXPECT_LE(error["mean_percent"].get<double>(), error["rms_percent"].get<double>()) << where;
  EXPECT_LE(error["rms_percent"].get<double>(), error["max_percent"].get<double>()) << where;
}

inline void ExpectNumbers(const nlohmann::json& object, const std::vector<std::string>& fields) {
  ASSERT_TRUE(object.is_object());
  for (const std::string& field : fields) {
    ASSERT_TRUE(object.contains(field)) << field;
    EXPECT_TRUE(object[field].is_number()) << field;
  }
}

inline void ExpectTrainReport(const nlohmann::json& report) {
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report.value("schema", ""), "pleat.train/1");
  ASSERT_TRUE(report.contains("rig"));
  const nlohmann::json& rig = report["rig"];
  ExpectNumbers(rig, {"rest_frame", "yaw_degrees", "residual"});
  ASSERT_TRUE(rig.contains("warnings") && rig["warnings"].is_array());
  ASSERT_TRUE(rig.contains("joints") && rig["joints"].is_array());
  ASSERT_EQ(rig["joints"].size(), 18u);
  for (size_t j = 0; j < rig["joints"].size(); ++j) {
    const nlohmann::json& joint = rig["joints"][j];
    EXPECT_TRUE(joint.at("name").is_string());
    EXPECT_LT(joint.at("parent").get<int>(), static_cast<int>(j));
    ASSERT_EQ(joint.at("position_m").size(), 3u);
    for (const nlohmann::json& coordinate : joint["position_m"])
      EXPECT_TRUE(coordinate.is_number());
  }
  EXPECT_EQ(rig["joints"][0]["parent"], -1);
  ExpectErrorFields(report.at("fit"), "fit");
  ExpectErrorFields(report.at("reconstruction"), "reconstruction");
  ExpectNumbers(report.at("poses"),
                {"jitter_degrees", "unsmoothed_jitter_degrees", "unsmoothed_rms_percent"});
  ASSERT_FALSE(report.at("worst_frames").empty());
  ExpectNumbers(report.at("worst_frames")[0], {"clip", "frame", "mean_percent"});
  ASSERT_EQ(report.at("worst_joints").size(), 17u);
  ExpectNumbers(report.at("worst_joints")[0], {"mean_percent"});
  EXPECT_TRUE(report.at("learner") == "gp" || report.at("learner") == "sgplvm" ||
              report.at("learner") == "regional");
  EXPECT_TRUE(report.at("options").is_object());
  EXPECT_EQ(report["options"].at("seed"), 1);
  ExpectNumbers(report.at("seconds"), {"read", "rig", "fit", "learn", "total"});
  EXPECT_GT(report.at("peak_memory_bytes").get<uint64_t>(), 1'000'000u);
  EXPECT_GT(report.at("model_bytes").get<uint64_t>(), 1000u);
}

inline void ExpectEvaluateReport(const nlohmann::json& report, const std::string& protocol) {
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report.value("schema", ""), "pleat.evaluate/1");
  EXPECT_EQ(report.at("protocol"), protocol);
  EXPECT_GT(report.at("diagonal_m").get<double>(), 0);
  EXPECT_TRUE(report.at("learner") == "gp" || report.at("learner") == "sgplvm" ||
              report.at("learner") == "regional");
  ExpectErrorFields(report.at("skinned"), "skinned");
  ExpectErrorFields(report.at("hybrid"), "hybrid");
  for (const char* baseline : {"zero", "mean", "nearest", "ridge"}) {
    ASSERT_TRUE(report.at("baselines").contains(baseline)) << baseline;
    ExpectErrorFields(report["baselines"][baseline], baseline);
  }
  for (const char* learner : {"sgplvm", "gp", "regional"}) {
    ASSERT_TRUE(report.at("learners").contains(learner)) << learner;
    ExpectErrorFields(report["learners"][learner], learner);
  }
  ExpectNumbers(report.at("seconds"), {"read", "rig", "fit", "learn", "predict"});
}

}  // namespace pleat
