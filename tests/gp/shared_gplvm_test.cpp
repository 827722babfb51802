#include "pleat/gp/shared_gplvm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "pleat/optimize/objective.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

GramData Data(const Eigen::MatrixXd& y) { return MakeGramData(y).value(); }

struct GradientCase {
  const char* name;
  std::vector<int> clip_starts;
  SharedGplvmOptions options;
  bool back_kernel;
};

SharedGplvmOptions With(void (*change)(SharedGplvmOptions&)) {
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.latent_dimension = 3;
  options.dynamics_weight = 1.7;  // not 1: public codes forgot it on some gradients
  options.pose_weight = .8;
  options.detail_weight = 1.3;
  change(options);
  return options;
}

class SharedGplvmGradientTest : public ::testing::TestWithParam<GradientCase> {};

TEST_P(SharedGplvmGradientTest, IsRight) {
  const GradientCase& c = GetParam();
  const int n = 14, q = c.options.latent_dimension;
  Eigen::MatrixXd back_kernel;
  if (c.back_kernel) {
    const Eigen::MatrixXd r = RandomMatrix(n, n, 9);
    back_kernel = (r + r.transpose()) / n + Eigen::MatrixXd::Identity(n, n);
  }
  SharedGplvmObjective objective(Data(RandomMatrix(n, 5, 1)), Data(RandomMatrix(n, 30, 2)),
                                 c.clip_starts, back_kernel, .4, c.options);
  const Eigen::VectorXd x = objective.Pack(RandomMatrix(n, q, 3), {-.3, .2, -1, -1.5},
                                           {.1, -.4, -1.2, -1.1}, {-.5, .3, 0, -1.3, -.8});
  const GradientCheck check = CheckGradient(objective, x);
  EXPECT_LT(check.max_relative_error, 1e-5)
      << "unknown " << check.worst_unknown << ": " << check.analytic << " vs " << check.numeric;
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SharedGplvmGradientTest,
    ::testing::Values(
        GradientCase{"OneClip", {0}, With([](auto&) {}), false},
        GradientCase{"TwoClips", {0, 6}, With([](auto&) {}), false},
        GradientCase{"ClipOfOneFrame", {0, 6, 7}, With([](auto&) {}), false},
        GradientCase{"SecondOrder", {0, 6}, With([](auto& o) { o.dynamics_order = 2; }), false},
        GradientCase{
            "SecondOrderShortClip", {0, 1, 3}, With([](auto& o) { o.dynamics_order = 2; }), false},
        GradientCase{
            "LinearDynamics", {0, 6}, With([](auto& o) { o.dynamics_linear = true; }), false},
        GradientCase{"NoDynamics", {0, 6}, With([](auto& o) { o.dynamics_weight = 0; }), false},
        GradientCase{"BackConstraints", {0, 6}, With([](auto&) {}), true},
        GradientCase{"BackConstraintsSecondOrder",
                     {0, 6},
                     With([](auto& o) { o.dynamics_order = 2; }),
                     true},
        GradientCase{"Prior", {0, 6}, With([](auto& o) { o.prior_precision = .3; }), false},
        GradientCase{"Everything",
                     {0, 6},
                     With([](auto& o) {
                       o.dynamics_order = 2;
                       o.dynamics_linear = true;
                       o.prior_precision = .3;
                       o.relative_noise_floor = 1e-2;
                     }),
                     true}),
    [](const auto& info) { return std::string(info.param.name); });

// Straddling rows would couple the clips: with the clips far apart in time nothing may change.
TEST(SharedGplvmObjectiveTest, ClipsAreIndependentInTheDynamics) {
  const int n = 12;
  const Eigen::MatrixXd y = RandomMatrix(n, 4, 1), z = RandomMatrix(n, 6, 2);
  const Eigen::MatrixXd x = RandomMatrix(n, 2, 3);
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.latent_dimension = 2;
  std::vector<int> swapped(n);  // second clip first
  std::iota(swapped.begin(), swapped.begin() + 7, 5);
  std::iota(swapped.begin() + 7, swapped.end(), 0);
  SharedGplvmObjective objective(Data(y), Data(z), {0, 5}, {}, 0, options);
  SharedGplvmObjective exchanged(Data(y(swapped, Eigen::all)), Data(z(swapped, Eigen::all)), {0, 7},
                                 {}, 0, options);
  const double value = objective.Evaluate(objective.Pack(x, {}, {}, {}), nullptr);
  const double other =
      exchanged.Evaluate(exchanged.Pack(x(swapped, Eigen::all), {}, {}, {}), nullptr);
  EXPECT_NEAR(value, other, 1e-9 * std::abs(value));
  SharedGplvmObjective joined(Data(y), Data(z), {0}, {}, 0, options);
  EXPECT_GT(std::abs(joined.Evaluate(joined.Pack(x, {}, {}, {}), nullptr) - value), 1e-3);
}

TEST(TrainSharedGplvmTest, LowersTheObjectiveAndIsDeterministic) {
  const SyntheticMotion motion = MakeSyntheticMotion(60, 12, 40, 1);
  for (const bool constrained : {false, true}) {
    SharedGplvmOptions options;
    options.latent_dimension = 4;
    options.max_iterations = 30;
    options.back_constraints = constrained;
    const DetailView details = MakeDetailView(motion.details, options.scaling);
    SharedGplvmSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const SharedGplvm first,
        TrainSharedGplvm(motion.features, details, {0, 30}, options, &summary));
    EXPECT_LT(summary.optimization.final_objective, summary.optimization.initial_objective - 1000);
    PLEAT_ASSERT_OK_AND_ASSIGN(const SharedGplvm second,
                               TrainSharedGplvm(motion.features, details, {0, 30}, options));
    EXPECT_EQ((first.latents - second.latents).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(first.back_weights.size() > 0, constrained);
  }
}

TEST(TrainSharedGplvmTest, OrderOfDetailsDoesNotMatter) {
  const SyntheticMotion motion = MakeSyntheticMotion(40, 12, 50, 1);
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.max_iterations = 5;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SharedGplvm first,
      TrainSharedGplvm(motion.features, MakeDetailView(motion.details, options.scaling), {0},
                       options));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SharedGplvm second,
      TrainSharedGplvm(motion.features,
                       MakeDetailView(motion.details.rowwise().reverse(), options.scaling), {0},
                       options));
  EXPECT_LT((first.latents - second.latents).norm(), 1e-5 * first.latents.norm());
}

TEST(DetailViewTest, ComponentsGiveTheGramMatrixOfTheDetails) {
  const Eigen::MatrixXd details = RandomMatrix(12, 7, 4);
  const PrincipalComponents all = ComputePca(details, {.max_components = 7, .min_energy = 1});
  std::vector<Eigen::Index> rows(12);
  std::iota(rows.begin(), rows.end(), 0);
  for (const ViewScaling scaling : {ViewScaling::kOneScalar, ViewScaling::kPerColumn}) {
    const DetailView expected = MakeDetailView(details, scaling);
    const DetailView view = MakeDetailView(all, rows, scaling);
    EXPECT_EQ(view.num_outputs, 7);
    EXPECT_LT((view.gram - expected.gram).norm(), 1e-9 * expected.gram.norm());
  }
}

// What few components leave out comes back on the diagonal, so that the energy is that of all.
TEST(DetailViewTest, WhatComponentsLeaveOutIsSpreadOverTheRows) {
  const Eigen::MatrixXd details = RandomMatrix(12, 7, 4);
  const PrincipalComponents few = ComputePca(details, {.max_components = 2, .min_energy = 1});
  ASSERT_LT(few.kept_energy, .9);
  std::vector<Eigen::Index> rows(12);
  std::iota(rows.begin(), rows.end(), 0);
  const DetailView view = MakeDetailView(few, rows, ViewScaling::kOneScalar);
  EXPECT_EQ(view.num_outputs, 7);
  const Eigen::MatrixXd centered = details.rowwise() - details.colwise().mean();
  EXPECT_NEAR(view.gram.trace(), centered.squaredNorm(), 1e-9 * centered.squaredNorm());
  const Eigen::MatrixXd beside = view.gram - few.scores * few.scores.transpose();
  EXPECT_LT((beside - beside(0, 0) * Eigen::MatrixXd::Identity(12, 12)).norm(), 1e-9);
}

TEST(TrainSharedGplvmTest, LbfgsDoesAtLeastAsWellWithAsManyEvaluations) {
  const SyntheticMotion motion = MakeSyntheticMotion(50, 12, 40, 2);
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.max_iterations = 50;
  const DetailView details = MakeDetailView(motion.details, options.scaling);
  SharedGplvmSummary scg, lbfgs;
  ASSERT_THAT(TrainSharedGplvm(motion.features, details, {0}, options, &scg), IsOk());
  options.optimizer = Optimizer::kLbfgs;
  ASSERT_THAT(TrainSharedGplvm(motion.features, details, {0}, options, &lbfgs), IsOk());
  EXPECT_EQ(lbfgs.optimization.initial_objective, scg.optimization.initial_objective);
  EXPECT_LT(lbfgs.optimization.final_objective,
            scg.optimization.final_objective + .01 * std::abs(scg.optimization.final_objective));
}

TEST(TrainSharedGplvmTest, SurvivesDuplicatedFramesAndConstantDetails) {
  SyntheticMotion motion = MakeSyntheticMotion(30, 8, 20, 3);
  motion.features.bottomRows(15) = motion.features.topRows(15);
  motion.details.bottomRows(15) = motion.details.topRows(15);
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.max_iterations = 20;
  EXPECT_THAT(TrainSharedGplvm(motion.features, MakeDetailView(motion.details, options.scaling),
                               {0}, options),
              IsOk());
  motion.details.setConstant(3);
  EXPECT_THAT(TrainSharedGplvm(motion.features, MakeDetailView(motion.details, options.scaling),
                               {0}, options),
              IsOk());
}

TEST(TrainSharedGplvmTest, StopsWhenCancelled) {
  const SyntheticMotion motion = MakeSyntheticMotion(40, 12, 30, 1);
  const DetailView details = MakeDetailView(motion.details, ViewScaling::kOneScalar);
  int num_tests = 0;
  const Progress progress(nullptr, [&] { return ++num_tests > 50; });
  EXPECT_THAT(TrainSharedGplvm(motion.features, details, {0}, {}, nullptr, progress),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("cancelled")));
  const Progress at_once(nullptr, [] { return true; });
  EXPECT_THAT(TrainSharedGplvm(motion.features, details, {0}, {}, nullptr, at_once),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("cancelled")));
}

TEST(TrainSharedGplvmTest, RefusesWrongDataWithWords) {
  const SyntheticMotion motion = MakeSyntheticMotion(20, 5, 10, 1);
  const DetailView details = MakeDetailView(motion.details, ViewScaling::kOneScalar);
  const auto refused = [&](const Eigen::MatrixXd& features, std::vector<int> starts,
                           SharedGplvmOptions options, const std::string& words) {
    EXPECT_THAT(TrainSharedGplvm(features, details, starts, options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused(motion.features.topRows(1), {0}, {}, "two frames");
  refused(motion.features.topRows(10), {0}, {}, "10 frames");
  refused(motion.features, {1}, {}, "clip starts");
  refused(motion.features, {0, 5, 5}, {}, "clip starts ascend");
  refused(motion.features, {0, 20}, {}, "clip starts ascend");
  refused(motion.features, {}, {}, "clip starts");
  refused(motion.features, {0}, {.latent_dimension = 0}, "latent dimension");
  refused(motion.features, {0}, {.dynamics_order = 3}, "order");
  Eigen::MatrixXd hole = motion.features;
  hole(3, 2) = std::nan("");
  refused(hole, {0}, {}, "not finite");
}

}  // namespace
}  // namespace pleat
