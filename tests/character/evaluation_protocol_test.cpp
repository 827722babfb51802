#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/character/evaluate.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(EvaluationProtocolTest, NamesRoundTripAndUnknownIsRefused) {
  for (const char* name : {"reconstruct", "every5th", "blocks10", "last30", "cross"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluationProtocol protocol, ParseEvaluationProtocol(name));
    EXPECT_STREQ(EvaluationProtocolName(protocol), name);
  }
  EXPECT_THAT(ParseEvaluationProtocol("leave-one-out"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("blocks10")));
}

TEST(EvaluationProtocolTest, Every5thTestsFramesThatAreTwoModuloFive) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                             SplitFrames(EvaluationProtocol::kEvery5th, 13));
  EXPECT_THAT(split.test, ElementsAre(2, 7, 12));
  EXPECT_EQ(split.train.size(), 10u);
}

TEST(EvaluationProtocolTest, Blocks10StartAtFifteenWithStepThirtyFive) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                             SplitFrames(EvaluationProtocol::kBlocks10, 89));
  // The block at 85 would start inside the last five frames' guard (85 >= 89 - 5 = 84).
  ASSERT_EQ(split.test.size(), 20u);
  EXPECT_EQ(split.test.front(), 15);
  EXPECT_EQ(split.test[9], 24);
  EXPECT_EQ(split.test[10], 50);
  EXPECT_EQ(split.test.back(), 59);
}

TEST(EvaluationProtocolTest, Blocks10WithACutLastBlock) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                             SplitFrames(EvaluationProtocol::kBlocks10, 57));
  EXPECT_EQ(split.test.back(), 56);  // block from 50 is cut by the end of the clip
}

TEST(EvaluationProtocolTest, EveryFrameIsOnExactlyOneSide) {
  for (const EvaluationProtocol protocol :
       {EvaluationProtocol::kEvery5th, EvaluationProtocol::kBlocks10,
        EvaluationProtocol::kLast30}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split, SplitFrames(protocol, 175));
    std::vector<int> all = split.train;
    all.insert(all.end(), split.test.begin(), split.test.end());
    std::sort(all.begin(), all.end());
    ASSERT_EQ(all.size(), 175u);
    for (int t = 0; t < 175; ++t) EXPECT_EQ(all[t], t);
  }
}

TEST(EvaluationProtocolTest, ReconstructUsesAllFramesOnBothSides) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                             SplitFrames(EvaluationProtocol::kReconstruct, 7));
  EXPECT_EQ(split.train, split.test);
  EXPECT_EQ(split.train.size(), 7u);
}

TEST(EvaluationProtocolTest, TooShortSequencesAreRefused) {
  EXPECT_THAT(SplitFrames(EvaluationProtocol::kBlocks10, 15),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("longer sequence")));
}

}  // namespace
}  // namespace pleat
