// What a query costs, and how the memory is laid out for it. With N kept rows and a region R of r_R
// outputs, a prediction is
//
//   mean_R = output_mean_R + sum_n k_R(x, x_n) alpha_R,n
//
// that is N kernel values and one product with an N x r_R matrix for each region. For 17 regions,
// 600 rows and 64 outputs each, these matrices have .65 million entries, 2.6 MB of floats that
// every query has to read. Three decisions follow:
//
// - All regions share one set of rows and one input scaling (RegionalGp::Train), so the rows are
//   stored once, and distances over columns that several sets share are summed only once
//   (regional_factors.h).
// - The alphas are float, row after row, region after region, in memory that begins on large pages,
//   and are read from front to back. Several queries at a time share one such pass (PredictRows).
//   Each query still sums in the same order, so a batch gives the same bits as single predictions.
// - Rows of alphas are filled up to whole registers, so that no output is summed by itself.
//
// Where regions share outputs, as in models before version 4 of the file, their sums add up in the
// order of the regions.
//
// `parameters_` keeps what else a model file needs, with alphas and inputs taken out; parameters()
// puts them back. A RegionalGp is immutable, and copies share the kernels.

#include "pleat/learner/regional_gp.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "absl/strings/str_cat.h"
#include "feature_sets.h"
#include "pleat/base/status.h"
#include "pleat/simd/weighted_rows.h"
#include "regional_factors.h"
#include "register_rows.h"

namespace pleat {
namespace {

absl::Status RefuseRegions(const std::string& what) {
  return absl::InvalidArgumentError("regional GP parameters: " + what);
}

bool IsPositive(double value) { return value > 0 && value < 1e30; }  // false for NaN

// False for what is not a number.
template <typename Values>
bool IsWithin(const Values& values, double bound) {
  return (values.array().abs() < bound).all();
}

absl::Status CheckScale(const RegionalGpParameters::Scale& scale, Eigen::Index num_inputs) {
  if (!IsFeatureSet(scale.columns, num_inputs)) {
    return RefuseRegions(absl::StrCat("the columns of a scale do not ascend below ", num_inputs));
  }
  if (!(scale.max_norm > 0)) return RefuseRegions("the largest norm of a scale is not positive");
  if (!IsPositive(scale.inverse_width) || !IsPositive(scale.amplitude) || !(scale.linear >= 0) ||
      !(scale.linear < 1e30)) {
    return RefuseRegions("a width, amplitude or slope is out of range");
  }
  return absl::OkStatus();
}

// The parameters may come from a damaged file. The bounds of 1e30 refuse what no training writes.
absl::Status CheckRegions(const RegionalGpParameters& p) {
  const Eigen::Index n = p.inputs.rows(), r = p.output_mean.size();
  if (n < 1 || p.inputs.cols() < 1 || r < 1 || p.regions.empty()) {
    return RefuseRegions("no rows, inputs, outputs or regions");
  }
  if (p.input_mean.size() != p.inputs.cols() || p.input_scales.size() != p.inputs.cols() ||
      !std::all_of(p.input_scales.begin(), p.input_scales.end(), IsPositive)) {
    return RefuseRegions("mean or scales of the inputs do not fit");
  }
  // The square of an input is kept in single precision.
  if (!IsWithin(p.inputs, 1e15) || !IsWithin(p.input_mean, 1e30) ||
      !IsWithin(p.output_mean, 1e30)) {
    return RefuseRegions("an input or a mean is not a number or out of range");
  }
  for (const RegionalGpParameters::Region& region : p.regions) {
    if (region.alpha.rows() != n || region.alpha.cols() < 1 || !region.alpha.allFinite()) {
      return RefuseRegions(absl::StrCat("alpha is ", region.alpha.rows(), " x ",
                                        region.alpha.cols(), " or not finite, expected ", n,
                                        " rows"));
    }
    if (region.first_output < 0 || region.alpha.cols() > r - region.first_output) {
      return RefuseRegions(absl::StrCat("a region has the outputs from ", region.first_output,
                                        " on, ", region.alpha.cols(), " of ", r));
    }
    if (region.scales.empty() || !(region.bias >= 0) || !(region.bias < 1e30)) {
      return RefuseRegions("a region without scales, or its bias is out of range");
    }
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      PLEAT_RETURN_IF_ERROR(CheckScale(scale, p.inputs.cols()));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<RegionalGp> RegionalGp::FromParameters(RegionalGpParameters parameters) {
  PLEAT_RETURN_IF_ERROR(CheckRegions(parameters));
  return RegionalGp(std::move(parameters));
}

RegionalGp::RegionalGp(RegionalGpParameters parameters)
    : parameters_(std::move(parameters)),
      num_rows_(parameters_.inputs.rows()),
      factors_(std::make_shared<const RegionalFactors>(parameters_)) {
  const Eigen::Index n = num_rows_;
  parameters_.inputs.resize(0, 0);
  size_t size = 0;
  for (const RegionalGpParameters::Region& region : parameters_.regions) {
    num_region_outputs_.push_back(region.alpha.cols());
    size += static_cast<size_t>(n * FilledUp(region.alpha.cols()));
  }
  alphas_.assign(size, 0);
  float* alpha = alphas_.data();
  for (RegionalGpParameters::Region& region : parameters_.regions) {
    const Eigen::Index stride = FilledUp(region.alpha.cols());
    Eigen::Map<RowMajorFloats>(alpha, n, stride).leftCols(region.alpha.cols()) = region.alpha;
    alpha += n * stride;
    region.alpha.resize(0, 0);
  }
}

RegionalGpParameters RegionalGp::parameters() const {
  RegionalGpParameters p = parameters_;
  const Eigen::Index n = num_rows_;
  p.inputs = factors_->Inputs(num_inputs());
  const float* alpha = alphas_.data();
  for (size_t i = 0; i < p.regions.size(); ++i) {
    const Eigen::Index stride = FilledUp(num_region_outputs_[i]);
    p.regions[i].alpha =
        Eigen::Map<const RowMajorFloats>(alpha, n, stride).leftCols(num_region_outputs_[i]);
    alpha += n * stride;
  }
  return p;
}

size_t RegionalGp::memory_bytes() const {
  return factors_->memory_bytes() + alphas_.size() * sizeof(float);
}

void RegionalGp::Predict(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace,
                         Eigen::Ref<Eigen::VectorXd> mean) const {
  assert(mean.size() == num_outputs());
  double* const target = mean.data();
  SetRow(row, workspace);
  PredictRows({&workspace, 1}, {&target, 1});
}

void RegionalGp::SetRow(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace) const {
  assert(row.size() == num_inputs());
  workspace->row = (row - parameters_.input_mean).cwiseQuotient(parameters_.input_scales);
  workspace->scratch.resize(static_cast<Eigen::Index>(factors_->scratch_size()));
  workspace->factors.resize(num_factors());
  factors_->Compute(workspace->row.data(), workspace->scratch.data(), workspace->factors.data());
}

void RegionalGp::PredictRows(std::span<Workspace* const> workspaces,
                             std::span<double* const> means) const {
  assert(workspaces.size() == means.size());
  for (size_t begin = 0; begin < workspaces.size(); begin += kMaxWeightedTogether) {
    const size_t count = std::min<size_t>(kMaxWeightedTogether, workspaces.size() - begin);
    std::array<const float*, kMaxWeightedTogether> factors{};
    std::array<float*, kMaxWeightedTogether> sums{};
    for (size_t q = 0; q < count; ++q) workspaces[begin + q]->sum.setZero(num_outputs());
    const Eigen::Index num_rows = num_rows_;
    const float* alpha = alphas_.data();
    for (size_t i = 0; i < parameters_.regions.size(); ++i) {
      const Eigen::Index first = parameters_.regions[i].first_output;
      const Eigen::Index num = num_region_outputs_[i], stride = FilledUp(num);
      for (size_t q = 0; q < count; ++q) {
        Workspace& w = *workspaces[begin + q];
        // The sum goes on from the regions before, so that shared outputs add up row by row.
        w.part.assign(static_cast<size_t>(stride), 0);
        std::copy_n(w.sum.data() + first, num, w.part.data());
        factors[q] = w.factors.data() + static_cast<Eigen::Index>(i) * num_rows;
        sums[q] = w.part.data();
      }
      AddWeightedRows({factors.data(), count}, alpha, num_rows, stride, {sums.data(), count});
      for (size_t q = 0; q < count; ++q) {
        Workspace& w = *workspaces[begin + q];
        std::copy_n(w.part.data(), num, w.sum.data() + first);
      }
      alpha += num_rows * stride;
    }
    for (size_t q = 0; q < count; ++q) {
      Eigen::Map<Eigen::VectorXd>(means[begin + q], num_outputs()) =
          parameters_.output_mean + workspaces[begin + q]->sum.cast<double>();
    }
  }
}

}  // namespace pleat
