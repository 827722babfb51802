#include "pleat/gp/regional_gp.h"

#include <cassert>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "dense.h"
#include "feature_sets.h"
#include "pleat/base/status.h"

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
  if (p.input_mean.size() != p.inputs.cols() || !IsPositive(p.input_scale)) {
    return Refuse("mean or scale of the inputs does not fit");
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
  std::vector<std::vector<int>> sets_of_column(num_inputs());
  int num_sets = 0;
  for (const RegionalGpParameters::Region& region : parameters_.regions) {
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      for (const int column : scale.columns) sets_of_column[column].push_back(num_sets);
      ++num_sets;
    }
  }
  std::map<std::vector<int>, int> atom_of_sets;
  std::vector<std::vector<int>> atoms_of_set(num_sets);
  for (int column = 0; column < num_inputs(); ++column) {
    const std::vector<int>& sets = sets_of_column[column];
    if (sets.empty()) continue;
    const auto [entry, is_new] = atom_of_sets.try_emplace(sets, static_cast<int>(atoms_.size()));
    if (is_new) {
      for (const int set : sets) atoms_of_set[set].push_back(entry->second);
      atoms_.emplace_back();
    }
    atoms_[entry->second].push_back(column);
  }
  int set = 0;
  for (const RegionalGpParameters::Region& region : parameters_.regions) {
    scale_atoms_.emplace_back(atoms_of_set.begin() + set,
                              atoms_of_set.begin() + set + region.scales.size());
    set += static_cast<int>(region.scales.size());
  }
}

size_t RegionalGp::memory_bytes() const {
  size_t bytes = static_cast<size_t>(parameters_.inputs.size()) * sizeof(double);
  for (const RegionalGpParameters::Region& region : parameters_.regions) {
    bytes += static_cast<size_t>(region.alpha.size()) * sizeof(float);
  }
  return bytes;
}

void RegionalGp::Predict(const Eigen::Ref<const Eigen::VectorXd>& row, Workspace* workspace,
                         Eigen::Ref<Eigen::VectorXd> mean) const {
  Workspace& w = *workspace;
  const RegionalGpParameters& p = parameters_;
  const Eigen::Index n = p.inputs.rows();
  assert(row.size() == num_inputs() && mean.size() == num_outputs());
  w.row = (row - p.input_mean) / p.input_scale;
  w.distances.setZero(n, static_cast<Eigen::Index>(atoms_.size()));
  w.products.setZero(n, static_cast<Eigen::Index>(atoms_.size()));
  for (size_t a = 0; a < atoms_.size(); ++a) {
    for (const int column : atoms_[a]) {
      w.distances.col(a).array() += (p.inputs.col(column).array() - w.row[column]).square();
      w.products.col(a) += w.row[column] * p.inputs.col(column);
    }
  }
  w.sum.setZero(num_outputs());
  for (size_t region = 0; region < p.regions.size(); ++region) {
    w.kernel.setConstant(n, p.regions[region].bias);
    for (size_t s = 0; s < p.regions[region].scales.size(); ++s) {
      const RegionalGpParameters::Scale& scale = p.regions[region].scales[s];
      w.rbf.setZero(n);
      w.linear.setZero(n);
      for (const int atom : scale_atoms_[region][s]) {
        w.rbf += w.distances.col(atom);
        w.linear += w.products.col(atom);
      }
      w.rbf *= -.5 * scale.inverse_width;
      ChosenDenseOps().exp_in_place(w.rbf.data(), n);
      w.kernel += scale.amplitude * w.rbf + scale.linear * w.linear;
    }
    w.kernel_f = w.kernel.cast<float>();
    w.sum.noalias() += p.regions[region].alpha.transpose() * w.kernel_f;
  }
  mean = p.output_mean + w.sum.cast<double>();
}

}  // namespace pleat
