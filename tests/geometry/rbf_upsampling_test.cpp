#include "pleat/geometry/rbf_upsampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pleat/base/random.h"
#include "pleat/geometry/control_mesh.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A tube of 40 rings x 30 vertices around y, 2 m long, radius 0.5 m; `offset` moves it along x.
MeshShape Tube(double offset = 0) {
  constexpr int kRings = 40, kSides = 30;
  MeshShape mesh;
  mesh.positions.resize(3, kRings * kSides);
  std::vector<int32_t> corners, sizes;
  for (int r = 0; r < kRings; ++r) {
    for (int s = 0; s < kSides; ++s) {
      const double angle = 2 * M_PI * s / kSides;
      const int v = r * kSides + s, next = r * kSides + (s + 1) % kSides;
      mesh.positions.col(v) << offset + 0.5 * std::cos(angle), 2.0 * r / kRings,
          0.5 * std::sin(angle);
      if (r + 1 == kRings) continue;
      corners.insert(corners.end(), {v, next, next + kSides, v + kSides});
      sizes.push_back(4);
    }
  }
  mesh.topology = *Topology::Create(kRings * kSides, corners, sizes);
  return mesh;
}

// Two tubes 1 mm apart, no shared vertex.
MeshShape TwoTubes() {
  const MeshShape left = Tube(), right = Tube(1.001);
  const int size = left.topology.num_vertices();
  MeshShape both;
  both.positions.resize(3, 2 * size);
  both.positions << left.positions, right.positions;
  std::vector<int32_t> corners = left.topology.corner_vertices();
  for (const int32_t v : right.topology.corner_vertices()) corners.push_back(v + size);
  both.topology = *Topology::Create(2 * size, corners, std::vector<int32_t>(corners.size() / 4, 4));
  return both;
}

// 3V displacements: a smooth field of the position.
Eigen::VectorXd SmoothField(const Eigen::Matrix3Xd& positions, double phase = 0) {
  Eigen::VectorXd field(3 * positions.cols());
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const Eigen::Vector3d p = positions.col(v);
    field.segment<3>(3 * v) << std::sin(2 * p.y() + phase), p.x() * p.z(), std::cos(p.x() + phase);
  }
  return field;
}

Eigen::VectorXd AtControls(const Eigen::VectorXd& field, const std::vector<int>& controls) {
  Eigen::VectorXd result(3 * controls.size());
  for (size_t c = 0; c < controls.size(); ++c) {
    result.segment<3>(3 * c) = field.segment<3>(3 * controls[c]);
  }
  return result;
}

double MeanError(const RbfUpsampler& upsampler, const Eigen::VectorXd& field,
                 const std::vector<int>& controls) {
  Eigen::VectorXd full;
  upsampler.Apply(AtControls(field, controls), &full);
  return (full - field).cwiseAbs().mean();
}

TEST(RbfUpsamplingTest, ExactAtControlVerticesAndForConstants) {
  const MeshShape mesh = Tube();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler upsampler,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
  EXPECT_EQ(upsampler.num_vertices(), 1200);
  EXPECT_EQ(upsampler.num_controls(), 120);
  Random random(2);
  Eigen::VectorXd control(360), full;
  for (double& value : control) value = random.Normal();
  upsampler.Apply(control, &full);
  EXPECT_EQ(AtControls(full, controls), control);
  for (int c = 0; c < 120; ++c) control.segment<3>(3 * c) << 1, -2, 3;
  upsampler.Apply(control, &full);
  for (int v = 0; v < 1200; ++v) {
    EXPECT_LT((full.segment<3>(3 * v) - Eigen::Vector3d(1, -2, 3)).norm(), 1e-5);
  }
}

TEST(RbfUpsamplingTest, SmoothFieldsAreInterpolatedBetterWithMoreControls) {
  const MeshShape mesh = Tube();
  const Eigen::VectorXd field = SmoothField(mesh.positions);
  double last = 1;
  for (const double fraction : {.05, .1, .25, .5, 1.0}) {
    const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, fraction);
    PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler upsampler,
                               RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
    const double error = MeanError(upsampler, field, controls);
    EXPECT_LT(error, last);
    last = error;
    EXPECT_LT(error, 0.02);
  }
  EXPECT_EQ(last, 0);
}

TEST(RbfUpsamplingTest, NearlyAffineFieldsAreNearlyReproduced) {
  // The long kernel behaves like a polyharmonic spline inside the controls' hull.
  const MeshShape mesh = Tube();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler upsampler,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
  Eigen::Matrix3d linear;
  linear << 1, 2, 3, -1, 0.5, 2, 0, 1, -2;
  const Eigen::Matrix3Xd affine = linear * mesh.positions;
  const Eigen::VectorXd field = affine.reshaped();
  EXPECT_LT(MeanError(upsampler, field, controls), 0.005 * field.cwiseAbs().mean());
}

TEST(RbfUpsamplingTest, NothingBleedsAcrossAGap) {
  const MeshShape mesh = TwoTubes();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .05);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler upsampler,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
  Eigen::VectorXd field = Eigen::VectorXd::Zero(3 * 2400);
  field.tail(3600).setOnes();  // one tube moves, the other stands
  EXPECT_LT(MeanError(upsampler, field, controls), 1e-5);
}

TEST(RbfUpsamplingTest, FeaturesSharpenATransition) {
  // A field that jumps where a feature does: kernel distances in the feature see the jump.
  const MeshShape mesh = Tube();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .05);
  RbfUpsamplingOptions options;
  options.features.resize(1, 1200);
  Eigen::VectorXd field = Eigen::VectorXd::Zero(3600);
  for (int v = 0; v < 1200; ++v) {
    options.features(0, v) = 1 / (1 + std::exp(-20 * (mesh.positions(1, v) - 1)));
    field[3 * v] = options.features(0, v);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler plain,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler featured,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls, options));
  EXPECT_LT(MeanError(featured, field, controls), 0.5 * MeanError(plain, field, controls));
}

TEST(RbfUpsamplingTest, RefinementLearnsFromAnAnimationAndGeneralizes) {
  const MeshShape mesh = Tube();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .05);
  // Rough but linear in the motion: every vertex mixes two smooth fields with its own factors.
  Random random(3);
  std::vector<std::pair<double, double>> factors(1200);
  for (auto& factor : factors) factor = {1 + 0.2 * random.Normal(), 0.2 * random.Normal()};
  auto frame = [&](double phase) {
    const Eigen::VectorXd a = SmoothField(mesh.positions, phase);
    Eigen::VectorXd mixed(3600);
    for (int v = 0; v < 1200; ++v) {
      mixed.segment<3>(3 * v) = factors[v].first * a.segment<3>(3 * v);
      mixed[3 * v] += factors[v].second * std::cos(2 * mesh.positions(1, v) + phase);
    }
    return mixed;
  };
  Eigen::MatrixXd training(40, 3600);
  for (int t = 0; t < 40; ++t) training.row(t) = frame(0.3 * t).transpose();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler plain,
                             RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
  UpsamplingRefinementOptions options{.num_threads = 1};
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler refined, plain.Refine(training, controls, options));
  const Eigen::VectorXd unseen = frame(0.17);
  EXPECT_LT(MeanError(refined, unseen, controls), 0.5 * MeanError(plain, unseen, controls));
  Eigen::VectorXd full;
  refined.Apply(AtControls(unseen, controls), &full);
  EXPECT_LT((AtControls(full, controls) - AtControls(unseen, controls)).norm(), 1e-12);

  options.num_threads = 3;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler threaded,
                             plain.Refine(training, controls, options));
  EXPECT_TRUE(threaded.matrix().isApprox(refined.matrix(), 0));
  // Nothing to learn from: the kernel weights stay.
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler still,
                             plain.Refine(Eigen::MatrixXd::Zero(2, 3600), controls));
  EXPECT_TRUE(still.matrix().isApprox(plain.matrix(), 0));
}

TEST(RbfUpsamplingTest, SameForEveryThreadCountAndPrecision) {
  const MeshShape mesh = Tube();
  const auto controls = *SelectControlVertices(mesh.topology, mesh.positions, .1);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const RbfUpsampler one,
      RbfUpsampler::Build(mesh.topology, mesh.positions, controls, {.num_threads = 1}));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const RbfUpsampler three,
      RbfUpsampler::Build(mesh.topology, mesh.positions, controls, {.num_threads = 3}));
  EXPECT_TRUE(one.matrix().isApprox(three.matrix(), 0));
  const Eigen::VectorXd control = AtControls(SmoothField(mesh.positions), controls);
  Eigen::VectorXd full;
  Eigen::VectorXf single;
  one.Apply(control, &full);
  one.Apply(control.cast<float>(), &single);
  EXPECT_LT((full - single.cast<double>()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(RbfUpsamplingTest, OddMeshesAreServed) {
  const MeshShape mesh = TwoTubes();
  // All controls on one tube: the other follows through the air. One control: constant.
  for (const std::vector<int>& controls : {std::vector<int>{5, 400, 900}, {7}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler upsampler,
                               RbfUpsampler::Build(mesh.topology, mesh.positions, controls));
    Eigen::VectorXd full;
    upsampler.Apply(Eigen::VectorXd::Ones(3 * controls.size()), &full);
    EXPECT_LT((full.array() - 1).abs().maxCoeff(), 1e-5);
  }
  // Everything at one place.
  const Eigen::Matrix3Xd point = Eigen::Matrix3Xd::Ones(3, 2400);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler flat,
                             RbfUpsampler::Build(mesh.topology, point, {0, 1, 2, 3}));
  EXPECT_TRUE(Eigen::MatrixXf(flat.matrix()).allFinite());
}

TEST(RbfUpsamplingTest, WrongInputIsRefusedWithWords) {
  const MeshShape mesh = Tube();
  auto build = [&](const std::vector<int>& controls, const RbfUpsamplingOptions& options = {}) {
    return RbfUpsampler::Build(mesh.topology, mesh.positions, controls, options);
  };
  const auto invalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(build({}), HasStatus(invalid, HasSubstr("no control")));
  EXPECT_THAT(build({3, 1200}), HasStatus(invalid, HasSubstr("1200")));
  EXPECT_THAT(build({3, -1}), HasStatus(invalid, HasSubstr("-1")));
  EXPECT_THAT(build({3, 3}), HasStatus(invalid, HasSubstr("twice")));
  EXPECT_THAT(build({3}, {.num_neighbors = 0}), HasStatus(invalid, HasSubstr("num_neighbors")));
  EXPECT_THAT(build({3}, {.features = Eigen::MatrixXd::Zero(2, 5)}),
              HasStatus(invalid, HasSubstr("feature")));
  EXPECT_THAT(RbfUpsampler::Build(mesh.topology, mesh.positions.leftCols(9), {3}),
              HasStatus(invalid, HasSubstr("9 rest")));
  EXPECT_THAT(RbfUpsampler::Build(mesh.topology, mesh.positions, {3}, {},
                                  Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("")));
  const RbfUpsampler upsampler = *build({3, 500});
  EXPECT_THAT(upsampler.Refine(Eigen::MatrixXd::Zero(2, 3599), {3, 500}),
              HasStatus(invalid, HasSubstr("3599")));
  EXPECT_THAT(upsampler.Refine(Eigen::MatrixXd::Zero(2, 3600), {3}),
              HasStatus(invalid, HasSubstr("1 control")));
}

TEST(RbfUpsamplingTest, StoredRowsAreChecked) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const RbfUpsampler good,
                             RbfUpsampler::FromRows(3, {0, 2, 2, 3}, {0, 2, 1}, {0.25f, 0.75f, 1}));
  EXPECT_EQ(good.num_vertices(), 3);
  EXPECT_EQ(good.matrix().coeff(0, 2), 0.75f);
  EXPECT_EQ(good.matrix().coeff(1, 1), 0);

  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto refused = HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("upsampling matrix"));
  EXPECT_THAT(RbfUpsampler::FromRows(3, {}, {}, {}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(0, {0}, {}, {}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {1, 2}, {0, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2}, {0, 1}, {1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 3}, {0, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 5, 2}, {0, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2, 1, 2}, {0, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2}, {0, 3}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2}, {-1, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2}, {1, 1}, {1, 1}), refused);
  EXPECT_THAT(RbfUpsampler::FromRows(3, {0, 2}, {0, 1}, {1, nan}), refused);
}

}  // namespace
}  // namespace pleat
