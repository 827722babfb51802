#include "cli/show/progress_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "cli/session.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ProgressDisplay, FormatsDurations) {
  EXPECT_EQ(FormatDuration(-1), "0 s");
  EXPECT_EQ(FormatDuration(59.4), "59 s");
  EXPECT_EQ(FormatDuration(59.6), "1 min 0 s");
  EXPECT_EQ(FormatDuration(3725), "1 h 2 min");
}

TEST(ProgressDisplay, BarShowsStageFractionAndTimeLeft) {
  const std::string bar = FormatProgressBar({"fit", 0.5, std::nullopt}, 12, std::nullopt, 79);
  EXPECT_EQ(bar, "fit        [############------------]  50 %  12 s, 12 s left");
  EXPECT_THAT(FormatProgressBar({"fit", 0.5, -12.5}, 12, 3.0, 100), HasSubstr("objective -12.5"));
  EXPECT_THAT(FormatProgressBar({"fit", 0.5, -12.5}, 12, 3.0, 100), HasSubstr("3 s left"));
}

TEST(ProgressDisplay, BarFitsTheTerminal) {
  EXPECT_EQ(FormatProgressBar({"a very long name of a stage", 0.5, 1.0}, 1e5, 1e5, 40).size(), 40u);
}

TEST(ProgressDisplay, ReachesAHundredPercentOnlyAtTheEnd) {
  EXPECT_THAT(FormatProgressLine({"fit", 0.9999, std::nullopt}, 1, std::nullopt),
              HasSubstr("99 %"));
  EXPECT_EQ(FormatProgressLine({"fit", 1, std::nullopt}, 1, std::nullopt), "fit: 100 %, 1 s");
}

// Fractions and times may come from a server.
TEST(ProgressDisplay, NumbersThatAreNoneAreShownAsNothingWorse) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(FormatDuration(nan), "0 s");
  EXPECT_EQ(FormatDuration(1e300), "277777 h 46 min");
  EXPECT_EQ(FormatDuration(infinity), FormatDuration(1e300));
  EXPECT_EQ(FormatDuration(-infinity), "0 s");
  for (const auto& [fraction, percent] : {std::pair(nan, " 0 %"), std::pair(-infinity, " 0 %"),
                                          std::pair(infinity, " 100 %"), std::pair(-.5, " 0 %")}) {
    EXPECT_THAT(FormatProgressLine({"fit", fraction, nan}, 3, nan), HasSubstr(percent));
    EXPECT_THAT(FormatProgressBar({"fit", fraction, nan}, 3, infinity, 79), HasSubstr(percent));
  }
}

TEST(ProgressDisplay, LinesAreFewAndNameEveryStage) {
  std::ostringstream out;
  double now = 0;
  ProgressDisplay display(out, ProgressStyle::kLines, [&now] { return now; });
  for (int i = 0; i < 1000; ++i) {
    now += 0.01;
    display.Update({i < 500 ? "rig" : "fit", i / 1000.0, std::nullopt});
  }
  for (int i = 0; i < 50; ++i) display.Update({i % 2 == 0 ? "a" : "b", 1, std::nullopt});
  display.Finish();
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3) << text;  // rig, fit, a
  EXPECT_THAT(text, HasSubstr("rig: "));
  EXPECT_THAT(text, HasSubstr("fit: "));
  EXPECT_THAT(text, Not(HasSubstr("\r")));
}

TEST(ProgressDisplay, BarIsRedrawnInPlaceAndEndsItsLine) {
  std::ostringstream out;
  double now = 0;
  ProgressDisplay display(out, ProgressStyle::kBar, [&now] { return now; });
  display.Update({"rig", 0.1, std::nullopt});  // too short a wait to speak of
  now = 1;
  display.Update({"rig", 0.2, std::nullopt});
  now = 1.01;
  display.Update({"rig", 0.25, std::nullopt});  // too soon to be drawn
  now = 2;
  display.Update({"rig", 0.3, std::nullopt});
  display.Finish();
  display.Finish();
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

// A job may start again, and a server may say anything.
TEST(ProgressDisplay, NeverRunsBackwards) {
  std::ostringstream out;
  double now = 1;
  ProgressDisplay display(out, ProgressStyle::kBar, [&now] { return now; });
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double fraction : {.1, .6, .2, nan, -1.0, .7, 5.0, .3}) {
    now += 1;
    display.Update({"fit", fraction, std::nullopt});
  }
  std::vector<int> percents;
  std::istringstream words(out.str());
  for (std::string word, last; words >> word; last = word) {
    if (word == "%") percents.push_back(std::stoi(last));
  }
  EXPECT_THAT(percents, ::testing::ElementsAre(10, 60, 60, 60, 60, 70, 100, 100));
}

// The stages of training never take just the share of the bar that they have: the seconds were
// measured on a dance and on a skirt, and the shares are those of TrainCharacter.
TEST(ProgressDisplay, AfterAQuarterOfTheTimeTheEstimateHoldsWithinAFactorOfTwo) {
  const std::vector<double> shares = {.06, .24, .03, .35, .29, .03};
  for (const std::vector<double>& seconds :
       {std::vector<double>{7.5, 22, 2, 24, 18, 2}, std::vector<double>{6, 35, 6, 82, 68, 2}}) {
    const double total = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    std::ostringstream out;
    double now = 0;
    ProgressDisplay display(out, ProgressStyle::kLines, [&now] { return now; });
    double stage_start = 0, done = 0;
    for (size_t i = 0; stage_start < total / 4; ++i) {
      const double end = std::min(stage_start + seconds[i], total / 4);
      for (; now < end; now += .01) {
        display.Update({"train", done + shares[i] * (now - stage_start) / seconds[i], {}});
      }
      stage_start += seconds[i];
      done += shares[i];
    }
    const std::string text = out.str();
    const size_t line = text.rfind("train: ");
    int percent = 0, elapsed = 0, minutes = 0, left = 0;
    ASSERT_EQ(std::sscanf(text.c_str() + line, "train: %d %%, %d s, %d min %d s left", &percent,
                          &elapsed, &minutes, &left),
              4)
        << text;
    left += 60 * minutes;
    EXPECT_GT(left, (total - elapsed) / 2) << text;
    EXPECT_LT(left, (total - elapsed) * 2) << text;
  }
}

TEST(ProgressDisplay, AddsUpTheSecondsOfStages) {
  std::ostringstream out;
  double now = 0;
  ProgressDisplay display(out, ProgressStyle::kSilent, [&now] { return now; });
  display.Update({"rig", 0.1, std::nullopt});
  now = 2;
  display.Update({"fit", 0.5, std::nullopt});
  now = 5;
  display.Update({"rig", 0.6, std::nullopt});
  now = 6;
  display.Finish();
  EXPECT_THAT(display.stage_seconds(),
              ::testing::ElementsAre(::testing::Pair("fit", 3), ::testing::Pair("rig", 3)));
  EXPECT_EQ(out.str(), "");
}

TEST(ProgressDisplay, StyleFollowsFlagsAndTerminal) {
  Session session;
  EXPECT_EQ(ChooseProgressStyle(session), ProgressStyle::kLines);
  session.err_is_terminal = true;
  EXPECT_EQ(ChooseProgressStyle(session), ProgressStyle::kBar);
  session.json = true;
  EXPECT_EQ(ChooseProgressStyle(session), ProgressStyle::kSilent);
  session.json = false;
  session.quiet = true;
  EXPECT_EQ(ChooseProgressStyle(session), ProgressStyle::kSilent);
}

}  // namespace
}  // namespace pleat
