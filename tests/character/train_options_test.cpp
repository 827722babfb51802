#include "pleat/character/train_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(TrainOptionsTest, TextRoundTripKeepsEveryOption) {
  TrainOptions options = TrainOptions::Paper();
  options.yaw_degrees = 271.25;
  options.detail_energy = 0.1 + 0.2;  // has no short decimal
  options.seed = std::numeric_limits<uint64_t>::max();
  options.dynamics_weight = 1e-3;
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions back,
                             ParseTrainOptions(FormatTrainOptions(options)));
  EXPECT_EQ(back, options);
}

TEST(TrainOptionsTest, DefaultsAndPaperAreValid) {
  EXPECT_THAT(ValidateTrainOptions({}), IsOk());
  EXPECT_THAT(ValidateTrainOptions(TrainOptions::Paper()), IsOk());
}

TEST(TrainOptionsTest, EachBadValueIsNamedWithItsRange) {
  const auto expect_refused = [](TrainOptions options, const char* name) {
    EXPECT_THAT(ValidateTrainOptions(options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(name)));
  };
  expect_refused({.learner = "magic"}, "learner");
  expect_refused({.fit = ""}, "fit");
  expect_refused({.detail_axes = "screen"}, "detail_axes");
  expect_refused({.deformation = "coarse"}, "deformation");
  expect_refused({.detail_coordinates = "polar"}, "detail_coordinates");
  expect_refused({.rotations = "matrix"}, "rotations");
  expect_refused({.history = 0}, "history");
  expect_refused({.resolution_percent = 0.5}, "resolution_percent");
  expect_refused({.resolution_percent = std::numeric_limits<double>::quiet_NaN()},
                 "resolution_percent");
  expect_refused({.rest_frame = -2}, "rest_frame");
  expect_refused({.yaw_degrees = 400}, "yaw_degrees");
  expect_refused({.latent_dimensions = 33}, "latent_dimensions");
  expect_refused({.iterations = 0}, "iterations");
  expect_refused({.dynamics_weight = -1}, "dynamics_weight");
  expect_refused({.detail_energy = 1.5}, "detail_energy");
  expect_refused({.max_components = 0}, "max_components");
}

TEST(TrainOptionsTest, ParserNamesUnknownAndUnreadableLines) {
  EXPECT_THAT(ParseTrainOptions("lerner=gp\n"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("lerner")));
  EXPECT_THAT(ParseTrainOptions("history=two\n"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history=two")));
  EXPECT_THAT(ParseTrainOptions("history"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history")));
}

}  // namespace
}  // namespace pleat
