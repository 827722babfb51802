#include "pleat/learner/regional_gp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Two limbs with three features each; output 0 hangs on the first limb, output 1 on the second, and
// a little of both on their product. In training the limbs move together.
struct TwoLimbs {
  Eigen::MatrixXd inputs;
  std::vector<GpRegion> regions;
  Eigen::MatrixXd outputs;
};

TwoLimbs MakeTwoLimbs(int rows, double phase_between_limbs) {
  TwoLimbs data;
  data.inputs.resize(rows, 6);
  data.outputs.resize(rows, 2);
  for (int t = 0; t < rows; ++t) {
    const double first = .25 * t, second = .25 * t + phase_between_limbs;
    data.inputs.row(t) << std::sin(first), std::cos(first), .3 * std::sin(2 * first),
        std::sin(second), std::cos(second), .3 * std::sin(2 * second);
    data.outputs(t, 0) = std::sin(2 * first) + .5 * std::cos(first);
    data.outputs(t, 1) = std::cos(2 * second) - .5 * std::sin(second);
  }
  for (int limb = 0; limb < 2; ++limb) {
    GpRegion region{{{0, 1, 2, 3, 4, 5}, {3 * limb, 3 * limb + 1, 3 * limb + 2}}, data.outputs};
    region.outputs.col(1 - limb).setZero();
    data.regions.push_back(std::move(region));
  }
  return data;
}

// The sum of what all regions predict, two outputs each.
Eigen::Vector2d PredictSum(const RegionalGp& gp, const Eigen::VectorXd& row) {
  RegionalGp::Workspace workspace;
  Eigen::VectorXd mean(gp.num_outputs());
  gp.Predict(row, &workspace, mean);
  return mean.reshaped(2, mean.size() / 2).rowwise().sum();
}

double RmsError(const RegionalGp& gp, const TwoLimbs& data) {
  double squares = 0;
  for (Eigen::Index t = 0; t < data.inputs.rows(); ++t) {
    squares += (PredictSum(gp, data.inputs.row(t).transpose()) - data.outputs.row(t).transpose())
                   .squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(data.outputs.size()));
}

TEST(RegionalGpTest, ReproducesItsTrainingRows) {
  const TwoLimbs data = MakeTwoLimbs(60, 0);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok()) << gp.status();
  EXPECT_LT(RmsError(*gp, data), .01);
}

TEST(RegionalGpTest, NearFeaturesCarryOverToNewCombinationsOfLimbs) {
  TwoLimbs data = MakeTwoLimbs(80, 0);
  // A second phase, so that the likelihood can tell which limb explains which output.
  const TwoLimbs other = MakeTwoLimbs(80, 1.3);
  data.inputs.conservativeResize(160, Eigen::NoChange);
  data.inputs.bottomRows(80) = other.inputs;
  for (int limb = 0; limb < 2; ++limb) {
    data.regions[limb].outputs.conservativeResize(160, Eigen::NoChange);
    data.regions[limb].outputs.bottomRows(80) = other.regions[limb].outputs;
  }
  const TwoLimbs unseen = MakeTwoLimbs(60, 3);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok()) << gp.status();
  std::vector<GpRegion> only_all = data.regions;
  for (GpRegion& region : only_all) region.feature_sets.resize(1);
  const absl::StatusOr<RegionalGp> without = RegionalGp::Train(data.inputs, only_all);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_LT(RmsError(*gp, unseen), .05);
  EXPECT_LT(RmsError(*gp, unseen), .3 * RmsError(*without, unseen));
}

TEST(RegionalGpTest, FewerRowsThanGivenStillPredict) {
  const TwoLimbs data = MakeTwoLimbs(120, .5);
  RegionalGpOptions options;
  options.max_hyperparameter_rows = 30;
  options.max_exact_rows = 119;
  options.max_rows = 60;
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions, options);
  ASSERT_TRUE(gp.ok()) << gp.status();
  EXPECT_EQ(gp->parameters().inputs.rows(), 60);
  EXPECT_LT(RmsError(*gp, data), .05);
}

TEST(RegionalGpTest, RestoredFromItsParametersPredictsTheSame) {
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok());
  const absl::StatusOr<RegionalGp> restored = RegionalGp::FromParameters(gp->parameters());
  ASSERT_TRUE(restored.ok()) << restored.status();
  const Eigen::VectorXd row = data.inputs.row(7).transpose();
  EXPECT_EQ(PredictSum(*gp, row), PredictSum(*restored, row));
}

TEST(RegionalGpTest, ScalesOfTheInputsAreUnitsOnly) {
  // The same data with every input in another unit, and the scales that undo it.
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  RegionalGpOptions options;
  options.input_scales = Eigen::VectorXd::LinSpaced(data.inputs.cols(), .5, 3);
  const Eigen::MatrixXd in_other_units = data.inputs * options.input_scales.asDiagonal();
  const absl::StatusOr<RegionalGp> plain = RegionalGp::Train(data.inputs, data.regions);
  const absl::StatusOr<RegionalGp> scaled =
      RegionalGp::Train(in_other_units, data.regions, options);
  ASSERT_TRUE(plain.ok() && scaled.ok());
  for (const int row : {3, 20, 33}) {
    EXPECT_LT((PredictSum(*plain, data.inputs.row(row).transpose()) -
               PredictSum(*scaled, in_other_units.row(row).transpose()))
                  .norm(),
              1e-4);
  }
  options.input_scales[1] = 0;
  EXPECT_EQ(RegionalGp::Train(data.inputs, data.regions, options).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(RegionalGpTest, RefusesHostileParameters) {
  const TwoLimbs data = MakeTwoLimbs(20, .5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp gp, RegionalGp::Train(data.inputs, data.regions));
  const auto refused = [&](auto change, const std::string& words) {
    RegionalGpParameters p = gp.parameters();
    change(p);
    EXPECT_THAT(RegionalGp::FromParameters(std::move(p)),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  refused([](auto& p) { p = {}; }, "no rows");
  refused([](auto& p) { p.regions.clear(); }, "or regions");
  refused([](auto& p) { p.input_mean.conservativeResize(5); }, "mean or scales");
  refused([](auto& p) { p.input_scales[2] = 0; }, "mean or scales");
  refused([](auto& p) { p.input_scales[2] = kInf; }, "mean or scales");
  refused([](auto& p) { p.inputs(4, 1) = kNan; }, "not a number or out of range");
  refused([](auto& p) { p.inputs(4, 1) = 1e39; }, "out of range");
  refused([](auto& p) { p.input_mean[3] = -kInf; }, "out of range");
  refused([](auto& p) { p.output_mean[0] = kInf; }, "out of range");
  refused([](auto& p) { p.regions[0].alpha.conservativeResize(19, Eigen::NoChange); }, "19 x 2");
  refused([](auto& p) { p.regions[1].first_output = 3; }, "from 3 on, 2 of 4");
  refused([](auto& p) { p.regions[1].first_output = -1; }, "from -1 on");
  refused([](auto& p) { p.regions[0].scales[0].max_norm = 0; }, "largest norm");
  refused([](auto& p) { p.regions[0].scales[0].max_norm = kNan; }, "largest norm");
  refused([](auto& p) { p.regions[1].alpha(0, 0) = std::nanf(""); }, "not finite");
  refused([](auto& p) { p.regions[0].scales.clear(); }, "without scales");
  refused([](auto& p) { p.regions[0].bias = kNan; }, "bias");
  refused([](auto& p) { p.regions[0].bias = -1; }, "bias");
  refused([](auto& p) { p.regions[1].scales[0].columns.back() = 6; }, "ascend below 6");
  refused([](auto& p) { p.regions[1].scales[0].columns.clear(); }, "ascend");
  refused([](auto& p) { p.regions[1].scales[1].inverse_width = 0; }, "width");
  refused([](auto& p) { p.regions[1].scales[1].amplitude = kNan; }, "amplitude");
  refused([](auto& p) { p.regions[1].scales[1].linear = 1e31; }, "slope");
}

TEST(RegionalGpTest, RefusesDataThatDoNotFitTogether) {
  const auto refused = [](auto change, const std::string& words) {
    TwoLimbs data = MakeTwoLimbs(20, .5);
    RegionalGpOptions options;
    change(data, options);
    EXPECT_THAT(RegionalGp::Train(data.inputs, data.regions, options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](auto& d, auto&) { d.inputs.conservativeResize(1, 6); }, "1 x 6");
  refused([](auto& d, auto&) { d.regions.clear(); }, "0 regions");
  refused([](auto& d, auto&) { d.inputs(3, 2) = std::nan(""); }, "finite rows");
  refused([](auto& d, auto&) { d.regions[1].outputs.conservativeResize(19, 2); }, "region 1");
  refused([](auto& d, auto&) { d.regions[1].outputs.resize(20, 0); }, "region 1");
  refused([](auto& d, auto&) { d.regions[0].outputs(3, 1) = std::nan(""); }, "region 0");
  refused([](auto& d, auto&) { d.regions[1].feature_sets.clear(); }, "no feature sets");
  refused([](auto& d, auto&) { d.regions[1].feature_sets[0] = {3, 2}; }, "does not ascend");
  refused([](auto& d, auto&) { d.regions[0].feature_sets[1] = {-1, 2}; }, "below 6");
  refused([](auto& d, auto&) { d.regions[0].feature_sets[1] = {}; }, "below 6");
  refused([](auto&, auto& o) { o.input_scales = Eigen::VectorXd::Ones(5); }, "got 5");
  refused([](auto&, auto& o) { o.input_scales = Eigen::VectorXd::Constant(6, -1); }, "positive");
}

// More regions than are trained at the same time, which see different sets.
TEST(RegionalGpTest, ManyRegionsAreTheSameForAnyThreadCountAndTheirProgressRises) {
  const TwoLimbs data = MakeTwoLimbs(30, .5);
  std::vector<GpRegion> regions;
  for (int r = 0; r < 7; ++r) {
    regions.push_back(data.regions[r % 2]);
    regions.back().outputs *= r + 1;
    regions.back().feature_sets.push_back({r % 6});
  }
  RegionalGpOptions options{.max_iterations = 8, .num_threads = 1};
  std::vector<double> fractions;
  const Progress progress(
      [&](const ProgressUpdate& update) { fractions.push_back(update.fraction); }, nullptr);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp one,
                             RegionalGp::Train(data.inputs, regions, options, progress));
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
  for (const int num_threads : {2, 7}) {
    options.num_threads = num_threads;
    PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp many,
                               RegionalGp::Train(data.inputs, regions, options));
    const RegionalGpParameters a = one.parameters(), b = many.parameters();
    for (size_t r = 0; r < regions.size(); ++r) {
      EXPECT_EQ(a.regions[r].alpha, b.regions[r].alpha);
      EXPECT_EQ(a.regions[r].bias, b.regions[r].bias);
      for (size_t e = 0; e < a.regions[r].scales.size(); ++e) {
        EXPECT_EQ(a.regions[r].scales[e].inverse_width, b.regions[r].scales[e].inverse_width);
        EXPECT_EQ(a.regions[r].scales[e].amplitude, b.regions[r].scales[e].amplitude);
        EXPECT_EQ(a.regions[r].scales[e].linear, b.regions[r].scales[e].linear);
      }
    }
  }
}

// A region that is cut into parts with the same sets is the region: hyperparameters do not know
// the unit of the outputs, and the mean is linear in them.
TEST(RegionalGpTest, PartsOfARegionAddUpToIt) {
  const TwoLimbs data = MakeTwoLimbs(50, .5);
  const std::vector<GpRegion> whole = {data.regions[0]};
  std::vector<GpRegion> parts(3, data.regions[0]);
  parts[0].outputs *= .5;
  parts[1].outputs *= .8;
  parts[2].outputs *= -.3;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp one, RegionalGp::Train(data.inputs, whole));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp three, RegionalGp::Train(data.inputs, parts));
  for (const double step : {0.0, .2, 3.0}) {
    const Eigen::VectorXd row = data.inputs.row(11).transpose().array() + step;
    EXPECT_LT((PredictSum(one, row) - PredictSum(three, row)).norm(), 1e-4) << step;
  }
  EXPECT_GT(three.memory_bytes(), one.memory_bytes());
}

// Outputs that several regions share add up, as in models before version 4 of the file.
TEST(RegionalGpTest, SharedOutputsAddUp) {
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp own, RegionalGp::Train(data.inputs, data.regions));
  RegionalGpParameters p = own.parameters();
  p.regions[1].first_output = 0;
  p.output_mean = (p.output_mean.head(2) + p.output_mean.tail(2)).eval();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp shared, RegionalGp::FromParameters(p));
  ASSERT_EQ(shared.num_outputs(), 2);
  for (const int row : {2, 17, 39}) {
    const Eigen::VectorXd features = data.inputs.row(row).transpose().array() + .1;
    EXPECT_LT((PredictSum(own, features) - PredictSum(shared, features)).norm(), 1e-5);
  }
}

// Far from the training a prediction depends on the direction alone: it neither fades nor grows.
TEST(RegionalGpTest, FarRowsAreShortenedToTheBound) {
  const TwoLimbs data = MakeTwoLimbs(60, .5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp gp, RegionalGp::Train(data.inputs, data.regions));
  const Eigen::VectorXd mean = data.inputs.colwise().mean().transpose();
  const Eigen::VectorXd direction = data.inputs.row(13).transpose() - mean;
  const double longest = (data.inputs.rowwise() - mean.transpose()).rowwise().norm().maxCoeff();
  // Every set of the row is beyond its bound from here on.
  const double beyond =
      1.5 * longest / direction.head(3).norm() + 1.5 * longest / direction.tail(3).norm();
  const Eigen::Vector2d at = PredictSum(gp, mean + beyond * direction);
  EXPECT_LT((PredictSum(gp, mean + 10 * beyond * direction) - at).norm(), 1e-4);
  EXPECT_LT((PredictSum(gp, mean + 1e3 * beyond * direction) - at).norm(), 1e-3);
  // The training itself is not touched.
  for (const RegionalGpParameters::Region& region : gp.parameters().regions) {
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      const double own =
          gp.parameters().inputs(Eigen::all, scale.columns).rowwise().norm().maxCoeff();
      EXPECT_NEAR(scale.max_norm, 1.5 * own, 1e-9);
    }
  }
}

// A limb that never moves, alone in a set, and a region without any detail.
TEST(RegionalGpTest, StillLimbsAndRegionsWithoutDetailAreLearned) {
  TwoLimbs data = MakeTwoLimbs(40, .5);
  data.inputs.rightCols(3).setConstant(.7);
  data.regions[1].outputs.setZero();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGp gp, RegionalGp::Train(data.inputs, data.regions));
  data.outputs.col(1).setZero();
  EXPECT_LT(RmsError(gp, data), .02);
}

TEST(RegionalGpTest, CancellationStops) {
  const TwoLimbs data = MakeTwoLimbs(60, 0);
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_EQ(RegionalGp::Train(data.inputs, data.regions, {}, cancelled).status().code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace pleat
