// A sum of Gaussian processes, one for each region of the body, every one additive over scales.
//
//   f(x) = sum_regions f_R(x)
//   k_R(x, x') = b + sum_sets [ a exp(-g/2 |x_set - x'_set|^2) + c x_set.x'_set ]
//
// The sets of a region are all joints, those near it, its own, and how its skin stretches: what the
// near joints explain carries over to poses whose far joints were never seen together with them,
// and close to the training frames the set of all features explains the rest. Source:
// docs/method/learner.md#regions; D. Duvenaud, H. Nickisch, C. E. Rasmussen, "Additive Gaussian
// Processes", NIPS 2011 (sums of kernels over subsets of the inputs).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/large_page_allocator.h"
#include "pleat/base/progress.h"

namespace pleat {

// The task of one region.
struct GpRegion {
  std::vector<std::vector<int>> feature_sets;  // columns of the features, each set ascending
  Eigen::MatrixXd outputs;                     // N x r_R: outputs of its own
};

struct RegionalGpOptions {
  int max_iterations = 25;  // limit of L-BFGS on the marginal likelihood, per region
  // As in GpRegressionOptions, for every set of features.
  double prior_precision = .003;
  int max_hyperparameter_rows = 400;  // as in GpRegressionOptions
  // With more rows than max_exact_rows, all of them are learned through max_rows inducing ones.
  int max_exact_rows = 1000;
  int max_rows = 600;
  // No query's row of a set is longer than this many times the longest of the training: beyond, it
  // is shortened to that. The linear terms stay bounded by it, so far from the training a
  // prediction neither fades nor runs away.
  double max_norm_ratio = 1.5;
  // What divides every input (D numbers), so that some count more than others (as a GpRegression on
  // the same inputs has learned); empty: one number for all. Only their ratios matter.
  Eigen::VectorXd input_scales{};
  int num_threads = 0;  // 0 = one per core; the result does not depend on it
};

// Everything that a prediction needs, and what a model file holds.
struct RegionalGpParameters {
  struct Scale {
    std::vector<int> columns;  // ascending
    double inverse_width = 1;  // g, 1 / (normalized input unit)^2
    double amplitude = 1;      // a, (normalized output unit)^2
    double linear = 0;         // c
    // Rows of the set that are longer are shortened to this, in normalized input units. Scales with
    // the same columns have the same bound.
    double max_norm = std::numeric_limits<double>::infinity();
  };
  struct Region {
    std::vector<Scale> scales;
    double bias = 0;        // b
    Eigen::MatrixXf alpha;  // N x r_R, K^-1 (y - mean), output unit
    // Its outputs are first_output, first_output + 1, ... Outputs of several regions add up where
    // they are the same.
    int first_output = 0;
  };
  Eigen::VectorXd input_mean;    // D
  Eigen::VectorXd input_scales;  // D, units of the inputs
  // N x D, normalized: (x - mean) / scale. A RegionalGp keeps them in single precision, and only
  // the columns that are in a set.
  Eigen::MatrixXd inputs;
  Eigen::VectorXd output_mean;  // r, of all outputs
  std::vector<Region> regions;
};

class RegionalFactors;  // src/regional_factors.h

// Immutable after training: queries share it without locks.
class RegionalGp {
 public:
  // The memory that one thread needs for its queries. It is sized by the first query and reused
  // without allocation.
  struct Workspace {
    Eigen::VectorXd row;      // D, normalized
    Eigen::VectorXd scratch;  // memory of RegionalFactors
    Eigen::VectorXf factors;  // R N, all kernels
    Eigen::VectorXf sum;      // r
    std::vector<float> part;  // the outputs of one region, filled up to whole registers
  };

  // Trains all regions, each on outputs of its own, which follow each other in the order of the
  // regions. inputs: N x D, rows are samples. The error is kInvalidArgument when sizes
  // differ, a column is out of range or a number is not finite, and kCancelled.
  static absl::StatusOr<RegionalGp> Train(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                          const std::vector<GpRegion>& regions,
                                          const RegionalGpOptions& options = {},
                                          const Progress& progress = {});

  // Takes parameters from a file: checks sizes, columns and that every number is finite
  // (kInvalidArgument).
  static absl::StatusOr<RegionalGp> FromParameters(RegionalGpParameters parameters);

  RegionalGpParameters parameters() const;
  int num_inputs() const { return static_cast<int>(parameters_.input_mean.size()); }
  int num_outputs() const { return static_cast<int>(parameters_.output_mean.size()); }
  size_t memory_bytes() const;

  // Computes the mean (r entries) of the outputs at `row` (D entries).
  void Predict(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace,
               Eigen::Ref<Eigen::VectorXd> mean) const;

  // Does the same in two halves, for several rows at once: the kernels of a row, and the means of
  // several such workspaces, which read the alphas once. means[q] receives r entries. The bits are
  // those of single predictions.
  void SetRow(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace) const;
  void PredictRows(std::span<Workspace* const> workspaces, std::span<double* const> means) const;

 private:
  explicit RegionalGp(RegionalGpParameters parameters);
  Eigen::Index num_factors() const {  // R N
    return num_rows_ * static_cast<Eigen::Index>(parameters_.regions.size());
  }

  RegionalGpParameters parameters_;               // without alphas and inputs
  Eigen::Index num_rows_ = 0;                     // N
  std::vector<Eigen::Index> num_region_outputs_;  // r_R of each
  // The alphas of all regions one after the other, each N x its outputs row by row, filled up with
  // zeros to whole registers. A query reads them once from front to back.
  std::vector<float, LargePageAllocator<float>> alphas_;
  std::shared_ptr<const RegionalFactors> factors_;  // the kernels
};

}  // namespace pleat
