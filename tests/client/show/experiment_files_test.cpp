#include "cli/show/experiment_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Key;

// Two groups over test frames 3, 4 and 8; no frame has both neighbors.
ExperimentReport MadeUpReport() {
  ExperimentReport report{.experiment = Experiment::kRepresentations, .rows = {}};
  for (const char* group : {"rotations", "details"}) {
    ExperimentRow row;
    row.variant = {group, std::string("of ") + group, {}};
    row.report.protocol = "every5th";
    row.report.learner = "gp";
    row.report.diagonal_m = 2;
    row.report.test_frames = {3, 4, 8};
    row.report.hybrid.mean_percent = .125;
    row.report.hybrid.frame_mean_percent = {.1, .125, .15};
    row.report.hybrid.num_motion_frames = 1;
    row.report.hybrid.motion_mean_mm = .75;
    row.report.skinned = row.report.hybrid;
    row.report.seconds["learn"] = 1.5;
    report.rows.push_back(row);
  }
  return report;
}

TEST(ExperimentFiles, TheTableHasTheInputSkinningAndEveryVariant) {
  const auto rows = ExperimentTableRows(MadeUpReport());
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0][1], "the input itself");
  EXPECT_EQ(rows[1][1], "skinned only");
  for (const auto& row : rows) EXPECT_EQ(row.size(), ExperimentTableHeader().size());
  EXPECT_EQ(rows[3][0], "details");
  EXPECT_EQ(rows[3][1], "of details");
  EXPECT_EQ(rows[3][2], "0.125");
  EXPECT_EQ(rows[3][8], "0.75");
  EXPECT_EQ(rows[3][9], "-");  // jitter needs three frames in a row
  EXPECT_EQ(rows[3][10], "1.50");
}

TEST(ExperimentFiles, MarkdownNamesWhatWasMeasuredAndThePlots) {
  const ExperimentSubject subject{"walk_a -> walk_b", "paper"};
  const std::string text = ExperimentMarkdown(MadeUpReport(), subject);
  EXPECT_THAT(text, HasSubstr("# representations, walk_a -> walk_b, protocol every5th"));
  EXPECT_THAT(text, HasSubstr("| details | of details | 0.125 |"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto plots, ExperimentPlots(MadeUpReport(), subject));
  EXPECT_THAT(
      plots,
      ElementsAre(Key("representations-details.png"), Key("representations-details.svg"),
                  Key("representations-rotations.png"), Key("representations-rotations.svg")));
  for (const auto& [name, bytes] : plots) {
    if (name.ends_with(".png")) {
      EXPECT_THAT(text, HasSubstr("](" + name + ")"));
    }
  }
}

TEST(ExperimentFiles, JsonHasAnEvaluationPerRow) {
  const nlohmann::ordered_json json = ExperimentJson(MadeUpReport(), {"samba", "default"});
  EXPECT_EQ(json["schema"], "pleat.experiment/1");
  EXPECT_EQ(json["experiment"], "representations");
  EXPECT_EQ(json["input"], "samba");
  ASSERT_EQ(json["rows"].size(), 2u);
  EXPECT_EQ(json["rows"][1]["comparison"], "details");
  EXPECT_EQ(json["rows"][1]["hybrid"]["mean_percent"], .125);
  EXPECT_TRUE(json["rows"][1]["motion"]["hybrid"]["jitter_mm"].is_null());
}

}  // namespace
}  // namespace pleat
