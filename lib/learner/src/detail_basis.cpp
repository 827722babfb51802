#include "pleat/learner/detail_basis.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/simd/expand_planes.h"
#include "pleat/simd/round_weights.h"

namespace pleat {
namespace {

constexpr int kLargest = 127;  // of a value; -128 stays unused, so that signs are symmetric

absl::Status RefuseBasis(const std::string& what) {
  return absl::InvalidArgumentError("detail basis: " + what);
}

absl::Status CheckBasis(const DetailBasisParameters& p) {
  const size_t num_planes = p.components.size();
  if (p.mean.size() < 1 || p.num_components < 1) return RefuseBasis("no details or no components");
  if (p.values.rows() != p.mean.size() || static_cast<size_t>(p.values.cols()) != num_planes ||
      p.scales.size() != num_planes) {
    return RefuseBasis(absl::StrCat("planes are ", p.values.rows(), " x ", p.values.cols(),
                                    " with ", p.scales.size(), " scales, expected ", p.mean.size(),
                                    " x ", num_planes));
  }
  if (!p.mean.allFinite()) return RefuseBasis("an entry of the mean is not finite");
  if (num_planes > static_cast<size_t>(DetailBasis::kMaxPlanes) * p.num_components) {
    return RefuseBasis(absl::StrCat(num_planes, " planes for ", p.num_components, " components"));
  }
  for (size_t i = 0; i < num_planes; ++i) {
    if (p.components[i] < (i == 0 ? 0 : p.components[i - 1]) ||
        p.components[i] >= p.num_components) {
      return RefuseBasis(
          absl::StrCat("the components of the planes do not ascend below ", p.num_components));
    }
    if (!std::isfinite(p.scales[i])) return RefuseBasis("a scale is not finite");
  }
  if ((p.values.array() < -kLargest).any()) return RefuseBasis("a value of a plane is -128");
  return absl::OkStatus();
}

// Place of a detail in the order by blocks.
inline int PlaceInBlocks(int row) {
  const int in_block = row % DetailBasis::kBlockDetails;
  return row - in_block + in_block % 3 * DetailBasis::kLanes + in_block / 3;
}

}  // namespace

static_assert(DetailBasis::kBlockDetails == kPlaneRows);

absl::StatusOr<DetailBasis> DetailBasis::Quantize(
    const Eigen::Ref<const Eigen::VectorXf>& mean, const Eigen::Ref<const Eigen::MatrixXd>& basis,
    const Eigen::Ref<const Eigen::VectorXd>& largest_steps) {
  if (basis.rows() < 1 || basis.cols() < 1) return RefuseBasis("no details or no components");
  if (!basis.cast<float>().allFinite()) return RefuseBasis("a number to round is not finite");
  DetailBasisParameters p;
  p.mean = mean;
  p.num_components = static_cast<int>(basis.cols());
  std::vector<Eigen::Matrix<int8_t, Eigen::Dynamic, 1>> planes;
  Eigen::VectorXd rest;
  for (int k = 0; k < p.num_components; ++k) {
    rest = basis.col(k);
    for (int plane = 0; plane < kMaxPlanes; ++plane) {
      const auto scale = static_cast<float>(rest.cwiseAbs().maxCoeff() / kLargest);
      if (!(scale > std::numeric_limits<float>::min())) break;
      const auto rounded = (rest / static_cast<double>(scale)).array().round();
      planes.push_back(rounded.max(-kLargest).min(kLargest).cast<int8_t>());
      p.components.push_back(k);
      p.scales.push_back(scale);
      if (scale <= largest_steps[k]) break;
      rest -= static_cast<double>(scale) * planes.back().cast<double>();
    }
  }
  p.values.resize(basis.rows(), static_cast<Eigen::Index>(planes.size()));
  for (size_t i = 0; i < planes.size(); ++i) p.values.col(i) = planes[i];
  return FromParameters(p);
}

absl::StatusOr<DetailBasis> DetailBasis::FromParameters(const DetailBasisParameters& parameters) {
  if (absl::Status status = CheckBasis(parameters); !status.ok()) return status;
  DetailBasis basis;
  basis.num_details_ = static_cast<int>(parameters.mean.size());
  basis.num_components_ = parameters.num_components;
  basis.components_ = parameters.components;
  basis.scales_ = parameters.scales;
  basis.has_one_plane_each_ = basis.num_planes() == basis.num_components_;
  for (int plane = 0; plane < basis.num_planes(); ++plane) {
    if (basis.components_[plane] != plane) basis.has_one_plane_each_ = false;
  }
  const size_t num_places = static_cast<size_t>(basis.num_blocks()) * kBlockDetails;
  basis.mean_.assign(num_places, 0);
  basis.values_.assign(num_places * 2 * basis.num_pairs(), 0);
  for (int row = 0; row < basis.num_details_; ++row) {
    basis.mean_[PlaceInBlocks(row)] = parameters.mean[row];
  }
  for (int row = 0; row < basis.num_details_; ++row) {
    for (int plane = 0; plane < basis.num_planes(); ++plane) {
      basis.values_[basis.PlaceOf(row, plane)] = parameters.values(row, plane);
    }
  }
  return basis;
}

DetailBasisParameters DetailBasis::parameters() const {
  DetailBasisParameters p;
  p.mean = Mean();
  p.num_components = num_components_;
  p.components = components_;
  p.scales = scales_;
  p.values.resize(num_details_, num_planes());
  for (int row = 0; row < num_details_; ++row) {
    for (int plane = 0; plane < num_planes(); ++plane) {
      p.values(row, plane) = values_[PlaceOf(row, plane)];
    }
  }
  return p;
}

size_t DetailBasis::PlaceOf(int row, int plane) const {
  const int place = PlaceInBlocks(row);
  const size_t block = place / kBlockDetails, lane = place % kBlockDetails;
  return ((block * num_pairs() + plane / 2) * kBlockDetails + lane) * 2 + plane % 2;
}

size_t DetailBasis::memory_bytes() const {
  return values_.size() + mean_.size() * sizeof(float) +
         components_.size() * (sizeof(int) + sizeof(float));
}

Eigen::VectorXf DetailBasis::Mean() const {
  Eigen::VectorXf mean(num_details_);
  for (int row = 0; row < num_details_; ++row) mean[row] = mean_[PlaceInBlocks(row)];
  return mean;
}

Eigen::MatrixXd DetailBasis::Dense() const {
  const DetailBasisParameters p = parameters();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_details_, num_components_);
  for (int plane = 0; plane < num_planes(); ++plane) {
    dense.col(p.components[plane]) +=
        static_cast<double>(p.scales[plane]) * p.values.col(plane).cast<double>();
  }
  return dense;
}

Eigen::VectorXd DetailBasis::FinestSteps() const {
  Eigen::VectorXd steps =
      Eigen::VectorXd::Constant(num_components_, std::numeric_limits<double>::infinity());
  for (int plane = 0; plane < num_planes(); ++plane) steps[components_[plane]] = scales_[plane];
  return steps;
}

void DetailBasis::SetCoefficients(const Eigen::Ref<const Eigen::VectorXf>& coefficients,
                                  Query* query) const {
  assert(coefficients.size() == num_components_);
  query->weights.resize(2 * num_pairs());
  if (num_planes() % 2 != 0) query->weights.back() = 0;
  const float* of_planes = coefficients.data();
  if (!has_one_plane_each_) {
    query->coefficients.resize(num_planes());
    for (int plane = 0; plane < num_planes(); ++plane) {
      query->coefficients[plane] = coefficients[components_[plane]];
    }
    of_planes = query->coefficients.data();
  }
  query->unit = RoundWeightsVariants().front().kernel(scales_.data(), of_planes, num_planes(),
                                                      query->weights.data());
}

void DetailBasis::ExpandBlocks(std::span<const Query* const> queries, int first_block,
                               int num_blocks, std::span<float* const> details) const {
  assert(queries.size() == details.size() && first_block >= 0 &&
         first_block + num_blocks <= this->num_blocks());
  const PlaneKernel& kernel = PlaneVariants().front().kernel;
  const size_t block_bytes = static_cast<size_t>(num_pairs()) * 2 * kBlockDetails;
  for (size_t begin = 0; begin < queries.size(); begin += kMaxTogether) {
    const size_t count = std::min<size_t>(kMaxTogether, queries.size() - begin);
    std::array<const int16_t*, kMaxTogether> weights{};
    std::array<float, kMaxTogether> units{};
    std::array<float*, kMaxTogether> targets{};
    for (size_t q = 0; q < count; ++q) {
      weights[q] = queries[begin + q]->weights.data();
      units[q] = queries[begin + q]->unit;
      targets[q] = details[begin + q];
    }
    const int8_t* values = values_.data() + first_block * block_bytes;
    const float* mean = mean_.data() + static_cast<size_t>(first_block) * kBlockDetails;
    for (int block = 0; block < num_blocks; ++block) {
      kernel.expand[count - 1](values, mean, num_pairs(), weights.data(), units.data(),
                               targets.data());
      values += block_bytes;
      mean += kBlockDetails;
      for (size_t q = 0; q < count; ++q) targets[q] += kBlockDetails;
    }
  }
}

void DetailBasis::Expand(const Query& query, Eigen::Ref<Eigen::VectorXf> detail) const {
  assert(detail.size() == num_details_);
  std::array<float, kBlockDetails> block;
  const std::array<const Query*, 1> queries = {&query};
  const std::array<float*, 1> target = {block.data()};
  for (int b = 0; b < num_blocks(); ++b) {
    ExpandBlocks(queries, b, 1, target);
    const int begin = b * kBlockDetails, end = std::min(begin + kBlockDetails, num_details_);
    for (int row = begin; row < end; ++row) detail[row] = block[PlaceInBlocks(row) - begin];
  }
}

}  // namespace pleat
