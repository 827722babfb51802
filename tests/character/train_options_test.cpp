#include "pleat/character/train_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/formats/model_file.h"
#include "pleat/skeleton/human_template.h"
#include "support/fake_training.h"
#include "support/option_choices.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr char kUnwritten[] = "jumps=refuse\n";

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
  expect_refused({.learner = LearnerChoice{77}}, "learner");
  expect_refused({.upsampling = Upsampling{-1}}, "upsampling");
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

TEST(TrainOptionsTest, TheEndsOfEveryRangeAreAllowed) {
  for (const TrainOptions& options : std::vector<TrainOptions>{{.history = 1},
                                                               {.history = 8},
                                                               {.resolution_percent = 1},
                                                               {.rest_frame = 0},
                                                               {.yaw_degrees = 0},
                                                               {.yaw_degrees = 360},
                                                               {.bend_stiffness = 1},
                                                               {.smoothness = 1},
                                                               {.latent_dimensions = 32},
                                                               {.iterations = 10000},
                                                               {.dynamics_weight = 1e6},
                                                               {.detail_energy = 0},
                                                               {.max_components = 1024},
                                                               {.seed = 0}}) {
    EXPECT_THAT(ValidateTrainOptions(options), IsOk()) << FormatTrainOptions(options);
    EXPECT_EQ(ParseTrainOptions(FormatTrainOptions(options)).value(), options);
  }
}

TEST(TrainOptionsTest, EveryNameRoundTripsThroughText) {
  int num_choices = 0;
  ForEachChoice(
      [&](const std::string& option, const std::string& name, const TrainOptions& options) {
        const std::string line = absl::StrCat(option, "=", name, "\n");
        const std::string text = FormatTrainOptions(options);
        EXPECT_TRUE(line == kUnwritten || text.find(line) != std::string::npos) << line;
        PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions back, ParseTrainOptions(line));
        EXPECT_EQ(back, options) << line;
        ++num_choices;
      });
  EXPECT_EQ(num_choices, 28);
}

// Models of before the option have no such line, and models of the same choices keep their bytes.
TEST(TrainOptionsTest, ANewOptionIsWrittenOnlyWhenItIsChosen) {
  EXPECT_THAT(FormatTrainOptions({}), testing::Not(HasSubstr("jumps")));
  EXPECT_THAT(FormatTrainOptions({}), testing::EndsWith("seed=1\n"));
  EXPECT_THAT(FormatTrainOptions({.jumps = JumpPolicy::kAllow}), HasSubstr("jumps=allow\n"));
}

TEST(TrainOptionsTest, PlacedJointsAreALineThatTheModelFileKeeps) {
  TrainOptions options;
  options.placed_joints = {{kLeftHand, {.7, 1.4, -.1}}, {kHead, {0, 1. / 3, 0}}};
  EXPECT_THAT(FormatTrainOptions(options),
              HasSubstr("placed_joints=leftHand=0.7,1.4,-0.1 head=0,0.3333333333333333,0\n"));
  CharacterModel::Parts parts = MakeFakeModel(MakeSwayingTube(2), {})->parts();
  parts.options = options;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, CharacterModel::Create(std::move(parts)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto back, DecodeModel(EncodeModel(*model)));
  EXPECT_EQ(back->options(), options);
  for (const char* line : {"placed_joints=tail=0,0,0", "placed_joints=head=0,0,0 head=0,0,0"}) {
    EXPECT_THAT(ParseTrainOptions(line), HasStatus(kInvalid, HasSubstr("option placed_joints: ")));
  }
  options.placed_joints.push_back({kNumHumanJoints, {0, 0, 0}});
  EXPECT_THAT(ValidateTrainOptions(options), HasStatus(kInvalid, HasSubstr("placed_joints")));
}

TEST(TrainOptionsTest, EveryNameRoundTripsThroughTheModelFile) {
  const MeshSequence clip = MakeSwayingTube(2);
  ForEachChoice(
      [&](const std::string& option, const std::string& name, const TrainOptions& options) {
        CharacterModel::Parts parts = MakeFakeModel(clip, options)->parts();
        parts.options = options;
        PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, CharacterModel::Create(std::move(parts)));
        PLEAT_ASSERT_OK_AND_ASSIGN(const auto back, DecodeModel(EncodeModel(*model)));
        EXPECT_EQ(back->options(), options) << option << " " << name;
      });
}

// A model file holds the options as text between sections of their own, so a name of the same
// length may stand in for another.
TEST(TrainOptionsTest, AModelFileWithAnUnknownNameIsRefused) {
  std::string bytes = EncodeModel(*MakeFakeModel(MakeSwayingTube(2), {}));
  const size_t at = bytes.find("refine=full\n");
  ASSERT_NE(at, std::string::npos);
  ASSERT_THAT(DecodeModel(bytes), IsOk());
  EXPECT_THAT(DecodeModel(bytes.replace(at, 11, "refine=fool")), testing::Not(IsOk()));
  EXPECT_THAT(ParseTrainOptions("refine=fool\n"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("none, joints, full")));
}

TEST(TrainOptionsTest, AnUnknownNameListsTheValidOnes) {
  ForEachChoice([&](const std::string& option, const std::string& name, const TrainOptions&) {
    for (const char* unknown : {"magic", "", "Auto", " gp"}) {
      EXPECT_THAT(
          ParseTrainOptions(absl::StrCat(option, "=", unknown, "\n")),
          HasStatus(absl::StatusCode::kInvalidArgument, AllOf(HasSubstr(option), HasSubstr(name))));
    }
  });
}

TEST(TrainOptionsTest, TheTextsAreThoseOfTheOptions) {
  std::vector<std::string> names, texts;
  const TrainOptions options;
  VisitTrainOptions(options, [&](const char* name, const auto&) { names.emplace_back(name); });
  for (const OptionText& text : OptionTexts()) texts.emplace_back(text.name);
  EXPECT_EQ(texts, names);
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
