// Training many additive GPs, one per region, on the same frames. Regions share the inputs: their
// rows, their mean and their scales, which may come from a GpRegression that has learned the
// relevance of joints, so that it is learned once. What a region has for itself is the choice of
// its feature sets, its outputs (its share of the details, in a basis of its own), and 3 E + 2
// hyperparameters for E sets.
//
// Units. For the likelihood, each set's columns are divided by one number (`unit`) that brings its
// rows to mean squared norm 1, and a region's outputs by one that brings entries to mean square 1.
// So the starting values and the prior fit every region, whether it is a sleeve that hardly moves
// or a skirt. Afterwards the units of the sets are folded into the hyperparameters (g and c are per
// squared input unit, hence divided by the square), and that of the outputs into alpha. A query
// then knows only one scaling of inputs, and no region needs its own.
//
// Rows. Hyperparameters are learned on at most 400 rows, as each iteration costs their cube.
// Predictions are made from all rows up to 1,000, since a query reads them all. With more frames
// than that there are 600 inducing rows: they are spread evenly and the same for all regions, and
// all frames are learned through them (pleat/gp/inducing.h), at a cost that grows linearly with the
// frames. The regions compute no variance; the direct GP beside them does.
//
// Threads. Regions are independent, so they are trained in parallel, each in memory of its own: a
// likelihood keeps 3 E + 3 square matrices of its rows. They go in batches of four. That bounds the
// memory, and between batches the progress of the whole is reported, as its sink is not for several
// threads; inside, regions see a token that can only be cancelled. Each region writes its own slot,
// so the result does not depend on the number of threads.

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "feature_sets.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/gp/additive_likelihood.h"
#include "pleat/gp/inducing.h"
#include "pleat/gp/scaling.h"
#include "pleat/learner/regional_gp.h"
#include "pleat/math/spread_rows.h"
#include "pleat/optimize/lbfgs.h"

namespace pleat {
namespace {

absl::Status CheckRegionalData(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                               const std::vector<GpRegion>& regions) {
  if (inputs.rows() < 2 || inputs.cols() < 1 || regions.empty() || !inputs.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrCat("a regional GP needs regions and at least two finite rows of inputs, got ",
                     inputs.rows(), " x ", inputs.cols(), " and ", regions.size(), " regions"));
  }
  for (size_t i = 0; i < regions.size(); ++i) {
    const GpRegion& region = regions[i];
    if (region.outputs.rows() != inputs.rows() || region.outputs.cols() < 1 ||
        !region.outputs.allFinite()) {
      return absl::InvalidArgumentError(absl::StrCat("the outputs of region ", i,
                                                     " are not finite or none, or not in ",
                                                     inputs.rows(), " rows"));
    }
    if (region.feature_sets.empty()) {
      return absl::InvalidArgumentError(absl::StrCat("region ", i, " has no feature sets"));
    }
    for (const std::vector<int>& set : region.feature_sets) {
      if (!IsFeatureSet(set, inputs.cols())) {
        return absl::InvalidArgumentError(
            absl::StrCat("a feature set of region ", i, " does not ascend below ", inputs.cols()));
      }
    }
  }
  return absl::OkStatus();
}

absl::Status CheckScales(const Eigen::VectorXd& scales, Eigen::Index num_inputs) {
  if (scales.size() == 0) return absl::OkStatus();
  if (scales.size() != num_inputs || !scales.allFinite() || !(scales.minCoeff() > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("a regional GP needs one positive scale for each of ", num_inputs,
                     " inputs, or none; got ", scales.size()));
  }
  return absl::OkStatus();
}

// The columns of one set for some rows, divided by `unit` so that the rows have mean squared norm
// 1.
struct ScaledSet {
  Eigen::MatrixXd inputs;
  double unit;
};

ScaledSet TakeSet(const Eigen::MatrixXd& inputs, const std::vector<Eigen::Index>& rows,
                  const std::vector<int>& columns) {
  ScaledSet set{inputs(rows, columns), 1};
  set.unit = PositiveRoot(set.inputs.squaredNorm() / static_cast<double>(rows.size()));
  set.inputs /= set.unit;
  return set;
}

// Solves alpha = K^-1 y, with K over the rows of `sets`. The likelihood serves only as the
// factorization of K, so it is given outputs of zero and no prior.
bool SolveRegion(const std::vector<Eigen::MatrixXd>& sets, const Eigen::VectorXd& logs,
                 const Eigen::MatrixXd& outputs, const Progress& progress, Eigen::MatrixXd* alpha) {
  AdditiveLikelihood likelihood(sets, GramData{Eigen::MatrixXd::Zero(outputs.rows(), 1), false, 1},
                                0, progress);
  if (!std::isfinite(likelihood.Evaluate(logs, nullptr))) return false;
  likelihood.Solve(outputs, *alpha);
  return true;
}

// Solves the same through the inducing rows `inducing` from all rows of inputs and outputs.
// `values` are those of the kernel, in the order of AdditiveLikelihood.
bool SolveInducedRegion(const Eigen::MatrixXd& inputs, const GpRegion& region,
                        const std::vector<double>& set_units,
                        const std::vector<Eigen::MatrixXd>& inducing, const Eigen::VectorXd& values,
                        const Eigen::MatrixXd& outputs, const Progress& progress,
                        Eigen::MatrixXd* alpha) {
  const auto scales = static_cast<int>(inducing.size());
  std::vector<AdditiveTerm> terms;
  for (int e = 0; e < scales; ++e) {
    terms.push_back({values[e], values[scales + e], values[2 * scales + e]});
  }
  const double noise = AdditiveLikelihood::Noise(values), bias = values[3 * scales + 1];
  const auto cross = [&](Eigen::Index begin, Eigen::Index count) {
    std::vector<Eigen::MatrixXd> rows;
    for (int e = 0; e < scales; ++e) {
      rows.push_back(inputs(Eigen::seqN(begin, count), region.feature_sets[e]).eval() /
                     set_units[e]);
    }
    return AdditiveCovariance(rows, inducing, terms, bias);
  };
  InducedWeights weights;
  if (!SolveInduced(
          AdditiveCovariance(inducing, inducing, terms, bias), noise, outputs, cross,
          [&] { return progress.cancelled(); }, false, &weights)) {
    return false;
  }
  *alpha = std::move(weights.alpha);
  return true;
}

// Learns one region: hyperparameters on `learning_rows`, weights on all rows of `inputs`, to be
// read at `rows`.
absl::Status TrainRegion(const Eigen::MatrixXd& inputs, const GpRegion& region,
                         const std::vector<Eigen::Index>& learning_rows,
                         const std::vector<Eigen::Index>& rows, const RegionalGpOptions& options,
                         const Progress& progress, RegionalGpParameters::Region* result) {
  Eigen::MatrixXd outputs = region.outputs.rowwise() - region.outputs.colwise().mean();
  const double unit = PositiveRoot(outputs.squaredNorm() / static_cast<double>(outputs.size()));
  outputs /= unit;

  const int scales = static_cast<int>(region.feature_sets.size());
  std::vector<Eigen::MatrixXd> sets;
  std::vector<double> set_units;
  for (const std::vector<int>& columns : region.feature_sets) {
    ScaledSet set = TakeSet(inputs, learning_rows, columns);
    sets.push_back(std::move(set.inputs));
    set_units.push_back(set.unit);
  }
  PLEAT_ASSIGN_OR_RETURN(GramData data, MakeGramData(outputs(learning_rows, Eigen::all)));
  AdditiveLikelihood likelihood(sets, std::move(data), options.prior_precision, progress);
  PLEAT_ASSIGN_OR_RETURN(
      const Eigen::VectorXd logs,
      MinimizeLbfgs(likelihood, likelihood.Start(),
                    {.max_iterations = options.max_iterations, .objective_tolerance = 1e-9}));

  const Eigen::VectorXd values =
      logs.cwiseMax(-kMaxKernelLog).cwiseMin(kMaxKernelLog).array().exp();
  for (int e = 0; e < scales; ++e) sets[e] = inputs(rows, region.feature_sets[e]) / set_units[e];
  Eigen::MatrixXd alpha;
  const bool solved =
      static_cast<Eigen::Index>(rows.size()) < inputs.rows()
          ? SolveInducedRegion(inputs, region, set_units, sets, values, outputs, progress, &alpha)
          : SolveRegion(sets, logs, outputs, progress, &alpha);
  if (!solved) {
    // A cancelled solve fails as well, and this tells the two apart.
    PLEAT_RETURN_IF_ERROR(progress.Report(0));
    return absl::InvalidArgumentError("the kernel matrix cannot be factored");
  }
  result->alpha = (unit * alpha).cast<float>();
  result->bias = values[3 * scales + 1];
  for (int e = 0; e < scales; ++e) {
    const double square = set_units[e] * set_units[e];
    const double longest = inputs(Eigen::all, region.feature_sets[e]).rowwise().norm().maxCoeff();
    result->scales.push_back({.columns = region.feature_sets[e],
                              .inverse_width = values[e] / square,
                              .amplitude = values[scales + e],
                              .linear = values[2 * scales + e] / square});
    // Columns that never differ bound nothing: whatever they are later says nothing either.
    if (longest > 0) result->scales.back().max_norm = options.max_norm_ratio * longest;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<RegionalGp> RegionalGp::Train(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                             const std::vector<GpRegion>& regions,
                                             const RegionalGpOptions& options,
                                             const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckRegionalData(inputs, regions));
  PLEAT_RETURN_IF_ERROR(CheckScales(options.input_scales, inputs.cols()));
  RegionalGpParameters p;
  p.input_mean = inputs.colwise().mean().transpose();
  Eigen::MatrixXd normalized = inputs.rowwise() - p.input_mean.transpose();
  p.input_scales = options.input_scales;
  if (p.input_scales.size() == 0) p.input_scales.setOnes(inputs.cols());
  normalized *= p.input_scales.cwiseInverse().asDiagonal();
  const double unit = PositiveRoot(normalized.squaredNorm() / static_cast<double>(inputs.rows()));
  p.input_scales *= unit;
  normalized /= unit;
  // The rows are kept as floats, in the file and in memory, so they are learned as such.
  normalized = normalized.cast<float>().cast<double>();
  const auto learning_rows = SpreadRows(inputs.rows(), options.max_hyperparameter_rows);
  const bool exact = inputs.rows() <= options.max_exact_rows;
  const auto rows = SpreadRows(inputs.rows(), exact ? inputs.rows() : options.max_rows);

  // The sink of `progress` is not for several threads: reports come between batches.
  const int num_regions = static_cast<int>(regions.size());
  const Progress cancellation(nullptr, [&progress] { return progress.cancelled(); });
  p.regions.resize(num_regions);
  int num_outputs = 0;
  for (int i = 0; i < num_regions; ++i) {
    p.regions[i].first_output = num_outputs;
    num_outputs += static_cast<int>(regions[i].outputs.cols());
  }
  p.output_mean.resize(num_outputs);
  for (int i = 0; i < num_regions; ++i) {
    p.output_mean.segment(p.regions[i].first_output, regions[i].outputs.cols()) =
        regions[i].outputs.colwise().mean().transpose();
  }
  std::vector<absl::Status> statuses(num_regions);
  constexpr int kBatch = 4;
  for (int begin = 0; begin < num_regions; begin += kBatch) {
    const int size = std::min(kBatch, num_regions - begin);
    ParallelFor(size, options.num_threads, [&](int item) {
      const int i = begin + item;
      statuses[i] = TrainRegion(normalized, regions[i], learning_rows, rows, options, cancellation,
                                &p.regions[i]);
    });
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(begin + size) / num_regions));
  }
  for (int i = 0; i < num_regions; ++i) {
    PLEAT_RETURN_IF_ERROR(WithContext(absl::StrCat("region ", i), statuses[i]));
  }
  p.inputs = normalized(rows, Eigen::all);
  return RegionalGp(std::move(p));
}

}  // namespace pleat
