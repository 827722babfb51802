#include <gmock/gmock.h>

#include <cmath>

#include "c_character.h"
#include "support/allocation_counter.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ParametersHandleTest : public CCharacterTest {
 protected:
  pleat_parameters Room() {
    rotations_.assign(12, -7);
    coefficients_.assign(2, -7);
    return {.struct_size = sizeof(pleat_parameters),
            .root_position = {},
            .rotations = rotations_.data(),
            .num_joints = 3,
            .coefficients = coefficients_.data(),
            .num_coefficients = 2,
            .confidence = -1};
  }

  std::vector<float> rotations_, coefficients_;
  Eigen::Matrix3Xf frame_;
  const std::vector<pleat_pose> poses_ = CHistory(20, 3);
};

TEST_F(ParametersHandleTest, PredictAndShowAreTheHalvesOfTheEvaluator) {
  FrameParameters expected;
  EvaluatedFrame expected_frame;
  ASSERT_TRUE(truth_.Predict(History(20, 3), false, &expected).ok());
  ASSERT_TRUE(truth_.Show(expected, {}, &expected_frame).ok());

  pleat_parameters parameters = Room();
  pleat_query query = Query(poses_, &frame_);
  ASSERT_EQ(pleat_predict(evaluator_.get(), &query, &parameters, &error_), PLEAT_OK)
      << error_.message;
  EXPECT_EQ(query.code, PLEAT_OK);
  EXPECT_EQ(Eigen::Map<Eigen::Vector3d>(parameters.root_position), expected.pose.root_position);
  for (int j = 0; j < 3; ++j) {
    EXPECT_EQ(Eigen::Map<Eigen::Vector4f>(rotations_.data() + 4 * j).cast<double>(),
              expected.pose.rotations[j].coeffs());
  }
  ASSERT_EQ(parameters.num_coefficients, 2u);
  EXPECT_EQ(Eigen::Map<Eigen::VectorXf>(coefficients_.data(), 2), expected.coefficients);
  EXPECT_EQ(parameters.confidence, expected.confidence);

  query.poses = nullptr;  // not looked at
  query.num_poses = 0;
  ASSERT_EQ(pleat_show(evaluator_.get(), &parameters, &query, &error_), PLEAT_OK) << error_.message;
  EXPECT_EQ(frame_, expected_frame.positions);
  EXPECT_EQ(query.confidence, expected.confidence);
}

TEST_F(ParametersHandleTest, WithoutCoefficientsItIsSkinnedOnly) {
  pleat_parameters parameters = Room();
  pleat_query query = Query(poses_, &frame_);
  query.flags = PLEAT_SKINNED_ONLY;
  ASSERT_EQ(pleat_predict(evaluator_.get(), &query, &parameters, &error_), PLEAT_OK);
  EXPECT_EQ(parameters.num_coefficients, 0u);
  EXPECT_EQ(coefficients_[0], -7) << "untouched";
  parameters.coefficients = nullptr;
  ASSERT_EQ(pleat_show(evaluator_.get(), &parameters, &query, &error_), PLEAT_OK) << error_.message;
  EvaluatedFrame skinned;
  ASSERT_TRUE(truth_.EvaluateSkinned(track_.pose(20), {}, &skinned).ok());
  EXPECT_LT((frame_ - skinned.positions).cwiseAbs().maxCoeff(), 2e-6f);
}

TEST_F(ParametersHandleTest, WhatDoesNotFitTheModelIsAnError) {
  pleat_parameters parameters = Room();
  pleat_query query = Query(poses_, &frame_);
  ASSERT_EQ(pleat_predict(evaluator_.get(), &query, &parameters, &error_), PLEAT_OK);
  const auto refused = [&](const pleat_parameters& bad, const char* word) {
    EXPECT_EQ(pleat_show(evaluator_.get(), &bad, &query, &error_), PLEAT_INVALID_ARGUMENT);
    EXPECT_EQ(query.code, PLEAT_INVALID_ARGUMENT);
    EXPECT_THAT(error_.message, HasSubstr(word));
    EXPECT_EQ(frame_(0, 0), -77) << "untouched";
  };
  pleat_parameters bad = parameters;
  bad.num_coefficients = size_t{1} << 60;
  refused(bad, "another model");
  bad = parameters;
  bad.coefficients = nullptr;
  refused(bad, "coefficients is NULL");
  bad = parameters;
  bad.rotations = nullptr;
  refused(bad, "rotations of the parameters is NULL");
  bad = parameters;
  bad.num_joints = 4;
  refused(bad, "4 joints");
  bad = parameters;
  bad.struct_size = 0;
  refused(bad, "struct_size");
  coefficients_[1] = NAN;
  refused(parameters, "not finite");
  coefficients_[1] = 0;
  rotations_[5] = 3;
  refused(parameters, "joint 1");

  bad = Room();
  bad.num_coefficients = 1;
  EXPECT_EQ(pleat_predict(evaluator_.get(), &query, &bad, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(coefficients_[0], -7) << "untouched";
  EXPECT_EQ(pleat_predict(nullptr, &query, &bad, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_predict(evaluator_.get(), nullptr, &bad, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_predict(evaluator_.get(), &query, nullptr, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_show(evaluator_.get(), nullptr, &query, nullptr), PLEAT_INVALID_ARGUMENT);
}

TEST_F(ParametersHandleTest, AllocateNothingAfterReserve) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted here";
  ASSERT_EQ(pleat_evaluator_reserve(evaluator_.get(), 1, &error_), PLEAT_OK);
  pleat_parameters parameters = Room();
  pleat_query query = Query(poses_, &frame_);
  const long before = NumAllocations();
  const pleat_code predicted = pleat_predict(evaluator_.get(), &query, &parameters, &error_);
  const pleat_code shown = pleat_show(evaluator_.get(), &parameters, &query, &error_);
  EXPECT_EQ(NumAllocations() - before, 0);
  EXPECT_EQ(predicted, PLEAT_OK);
  EXPECT_EQ(shown, PLEAT_OK);
}

}  // namespace
}  // namespace pleat
