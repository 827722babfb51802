#include "pleat/gp/regional_gp.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "dense.h"
#include "feature_sets.h"
#include "pleat/base/status.h"
#include "weighted_rows.h"

namespace pleat {
namespace {

absl::Status Refuse(const std::string& what) {
  return absl::InvalidArgumentError("regional GP parameters: " + what);
}

bool IsPositive(double value) { return value > 0 && value < 1e30; }  // false for not a number

absl::Status CheckScale(const RegionalGpParameters::Scale& scale, Eigen::Index num_inputs) {
  if (!IsFeatureSet(scale.columns, num_inputs)) {
    return Refuse(absl::StrCat("the columns of a scale do not ascend below ", num_inputs));
  }
  if (!IsPositive(scale.inverse_width) || !IsPositive(scale.amplitude) || !(scale.linear >= 0) ||
      !(scale.linear < 1e30)) {
    return Refuse("a width, amplitude or slope is out of range");
  }
  return absl::OkStatus();
}

absl::Status CheckParameters(const RegionalGpParameters& p) {
  const Eigen::Index n = p.inputs.rows(), r = p.output_mean.size();
  if (n < 1 || p.inputs.cols() < 1 || r < 1 || p.regions.empty()) {
    return Refuse("no rows, inputs, outputs or regions");
  }
  if (p.input_mean.size() != p.inputs.cols() || p.input_scales.size() != p.inputs.cols() ||
      !std::all_of(p.input_scales.begin(), p.input_scales.end(), IsPositive)) {
    return Refuse("mean or scales of the inputs do not fit");
  }
  if (!p.input_mean.allFinite() || !p.inputs.allFinite() || !p.output_mean.allFinite()) {
    return Refuse("an input or a mean is not finite");
  }
  for (const RegionalGpParameters::Region& region : p.regions) {
    if (region.alpha.rows() != n || region.alpha.cols() != r || !region.alpha.allFinite()) {
      return Refuse(absl::StrCat("alpha is ", region.alpha.rows(), " x ", region.alpha.cols(),
                                 " or not finite, expected ", n, " x ", r));
    }
    if (region.scales.empty() || !(region.bias >= 0) || !(region.bias < 1e30)) {
      return Refuse("a region without scales, or its bias is out of range");
    }
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      PLEAT_RETURN_IF_ERROR(CheckScale(scale, p.inputs.cols()));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<RegionalGp> RegionalGp::FromParameters(RegionalGpParameters parameters) {
  PLEAT_RETURN_IF_ERROR(CheckParameters(parameters));
  return RegionalGp(std::move(parameters));
}

RegionalGp::RegionalGp(RegionalGpParameters parameters) : parameters_(std::move(parameters)) {
  const Eigen::Index n = parameters_.inputs.rows();
  alphas_.resize(n * static_cast<Eigen::Index>(parameters_.regions.size()), num_outputs());
  std::map<std::vector<int>, int> set_of_columns;
  for (size_t r = 0; r < parameters_.regions.size(); ++r) {
    RegionalGpParameters::Region& region = parameters_.regions[r];
    alphas_.middleRows(n * static_cast<Eigen::Index>(r), n) = region.alpha;
    region.alpha.resize(0, 0);
    scale_set_.emplace_back();
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      const auto next = static_cast<int>(set_of_columns.size());
      scale_set_.back().push_back(set_of_columns.try_emplace(scale.columns, next).first->second);
    }
  }
  std::vector<std::vector<int>> sets_of_column(num_inputs());
  for (const auto& [columns, set] : set_of_columns) {
    for (const int column : columns) sets_of_column[column].push_back(set);
  }
  set_atoms_.resize(set_of_columns.size());
  std::map<std::vector<int>, int> atom_of_sets;
  for (int column = 0; column < num_inputs(); ++column) {
    const std::vector<int>& sets = sets_of_column[column];
    if (sets.empty()) continue;
    const auto [entry, is_new] = atom_of_sets.try_emplace(sets, static_cast<int>(atoms_.size()));
    if (is_new) {
      for (const int set : sets) set_atoms_[set].push_back(entry->second);
      atoms_.emplace_back();
    }
    atoms_[entry->second].push_back(column);
  }
}

RegionalGpParameters RegionalGp::parameters() const {
  RegionalGpParameters p = parameters_;
  const Eigen::Index n = p.inputs.rows();
  for (size_t r = 0; r < p.regions.size(); ++r) {
    p.regions[r].alpha = alphas_.middleRows(n * static_cast<Eigen::Index>(r), n);
  }
  return p;
}

size_t RegionalGp::memory_bytes() const {
  return static_cast<size_t>(parameters_.inputs.size()) * sizeof(double) +
         static_cast<size_t>(alphas_.size()) * sizeof(float);
}

void RegionalGp::Predict(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace,
                         Eigen::Ref<Eigen::VectorXd> mean) const {
  Workspace& w = *workspace;
  const RegionalGpParameters& p = parameters_;
  const Eigen::Index n = p.inputs.rows();
  assert(row.size() == num_inputs() && mean.size() == num_outputs());
  w.row = (row - p.input_mean).cwiseQuotient(p.input_scales);
  w.atom_distances.setZero(n, static_cast<Eigen::Index>(atoms_.size()));
  w.atom_products.setZero(n, static_cast<Eigen::Index>(atoms_.size()));
  for (size_t a = 0; a < atoms_.size(); ++a) {
    for (const int column : atoms_[a]) {
      w.atom_distances.col(a).array() += (p.inputs.col(column).array() - w.row[column]).square();
      w.atom_products.col(a) += w.row[column] * p.inputs.col(column);
    }
  }
  w.distances.setZero(n, static_cast<Eigen::Index>(set_atoms_.size()));
  w.products.setZero(n, static_cast<Eigen::Index>(set_atoms_.size()));
  for (size_t set = 0; set < set_atoms_.size(); ++set) {
    for (const int atom : set_atoms_[set]) {
      w.distances.col(set) += w.atom_distances.col(atom);
      w.products.col(set) += w.atom_products.col(atom);
    }
  }
  w.factors.resize(alphas_.rows());
  for (size_t r = 0; r < p.regions.size(); ++r) {
    w.kernel.setConstant(n, p.regions[r].bias);
    for (size_t s = 0; s < p.regions[r].scales.size(); ++s) {
      const RegionalGpParameters::Scale& scale = p.regions[r].scales[s];
      const int set = scale_set_[r][s];
      w.rbf = -.5 * scale.inverse_width * w.distances.col(set);
      ChosenDenseOps().exp_in_place(w.rbf.data(), n);
      w.kernel += scale.amplitude * w.rbf + scale.linear * w.products.col(set);
    }
    w.factors.segment(n * static_cast<Eigen::Index>(r), n) = w.kernel.cast<float>();
  }
  w.sum.setZero(num_outputs());
  AddWeightedRows(w.factors.data(), alphas_.data(), alphas_.rows(), alphas_.cols(), w.sum.data());
  mean = p.output_mean + w.sum.cast<double>();
}

}  // namespace pleat
