#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class CompareVerbTest : public testing::Test {
 protected:
  void SetUp() override {
    const MeshSequence truth = MovingTetrahedron(4);
    ASSERT_THAT(WriteSequenceFile(truth_, truth), IsOk());
    ASSERT_THAT(WriteSequenceFile(moved_, Moved(truth, {.003f, 0, .004f})), IsOk());
  }

  const TemporaryFolder folder_;
  const std::string truth_ = folder_.File("truth.pseq"), moved_ = folder_.File("moved.pseq");
};

TEST_F(CompareVerbTest, AnOffsetIsItsOwnError) {
  const Outcome outcome = RunPleat({"compare", moved_, truth_, "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.compare/1");
  EXPECT_EQ(json["num_frames"], 4);
  EXPECT_NEAR(json["diagonal_m"].get<double>(), std::sqrt(3), 1e-6);
  EXPECT_NEAR(json["error"]["mean_mm"].get<double>(), 5, 1e-3);
  EXPECT_NEAR(json["error"]["mean_percent"].get<double>(), .5 / std::sqrt(3), 1e-4);
  EXPECT_NEAR(json["error"]["max_percent"].get<double>(), .5 / std::sqrt(3), 1e-4);
}

TEST_F(CompareVerbTest, AnAnimationHasNoDistanceFromItself) {
  const Outcome outcome = RunPleat({"compare", truth_, truth_, "--json"});
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["error"]["max_percent"], 0);
}

TEST_F(CompareVerbTest, TheTableNamesWhatPercentsAreOf) {
  const Outcome outcome = RunPleat({"compare", moved_, truth_});
  EXPECT_EQ(outcome.code, ExitCode::kOk);
  EXPECT_THAT(outcome.out, HasSubstr("difference"));
  EXPECT_THAT(outcome.out, HasSubstr("% of the diagonal of frame 0 of " + truth_ + ", 1.732 m"));
}

TEST_F(CompareVerbTest, AnimationsThatDoNotCorrespondAreRefusedWithBothCounts) {
  ASSERT_THAT(WriteSequenceFile(folder_.File("short.pseq"), MovingTetrahedron(3)), IsOk());
  const Outcome outcome = RunPleat({"compare", folder_.File("short.pseq"), truth_});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("the inputs do not correspond: 3 frames of 4 vertices "
                                     "against 4 of 4"));
}

}  // namespace
}  // namespace pleat
