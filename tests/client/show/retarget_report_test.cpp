#include "cli/show/retarget_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RetargetSummary SmallSummary() {
  RetargetSummary summary{
      .source = "a.bvh", .num_frames = 90, .num_joints = 31, .fps = 120, .map = {}, .report = {}};
  summary.map.joints = {{"hips", "Hips", "Hips", BoneAlignment::kRotation},
                        {"head", "", "", BoneAlignment::kDirection}};
  summary.map.left_out = {"LThumb"};
  summary.report.unit = {.name = "centimeters", .unit_m = .01, .size = 230};
  summary.report.sliding = {.num_frames = 40, .mean_mm = 1.25, .max_mm = 6};
  return summary;
}

TEST(RetargetReportTest, PeopleReadWhatWasMappedAndHowFeetSlide) {
  RetargetSummary summary = SmallSummary();
  EXPECT_THAT(RetargetText(summary),
              AllOf(HasSubstr("90 frames at 120 fps of 31 joints"), HasSubstr("centimeters"),
                    HasSubstr("Y up"), HasSubstr("rotation"), HasSubstr("left out: LThumb"),
                    HasSubstr("follow the bone above: head"), HasSubstr("1.25 mm per contact"),
                    Not(HasSubstr("cleaned"))));
  summary.feet.emplace();
  summary.report.up = ClipUp::kZ;
  summary.report.rest_stands = false;
  EXPECT_THAT(RetargetText(summary), AllOf(HasSubstr("cleaned"), HasSubstr("Z up"),
                                           HasSubstr("twists are solved from its motion")));
}

TEST(RetargetReportTest, ProgramsReadTheSame) {
  RetargetSummary summary = SmallSummary();
  nlohmann::ordered_json json = RetargetJson(summary);
  EXPECT_EQ(json["mapped"].size(), 1u);
  EXPECT_EQ(json["mapped"][0]["align"], "rotation");
  EXPECT_EQ(json["unmapped"][0], "head");
  EXPECT_EQ(json["sliding"]["motion"]["mean_mm_per_frame"], 1.25);
  EXPECT_FALSE(json.contains("cleaning"));
  summary.feet.emplace();
  json = RetargetJson(summary);
  EXPECT_EQ(json["cleaning"]["unreached_frames"], 0);
}

}  // namespace
}  // namespace pleat
