#include "pleat/learner/parted_basis.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status RefuseParts(const std::string& what) {
  return absl::InvalidArgumentError("parts of the detail basis: " + what);
}

bool AscendsBelow(const std::vector<int>& numbers, int end) {
  return numbers.empty() || (numbers.front() >= 0 && numbers.back() < end &&
                             std::adjacent_find(numbers.begin(), numbers.end(),
                                                std::greater_equal<>()) == numbers.end());
}

int64_t CountDetails(const PartedBasisParameters& p) {
  int64_t count = 0;
  for (const PartedBasisParameters::Part& part : p.parts) count += part.basis.mean.size();
  return count;
}

absl::Status CheckPart(const PartedBasisParameters::Part& part, int num_vertices,
                       int num_coefficients) {
  if (static_cast<size_t>(part.basis.mean.size()) != 3 * part.vertices.size() ||
      !AscendsBelow(part.vertices, num_vertices)) {
    return RefuseParts(absl::StrCat("a part has ", part.basis.mean.size(), " details for ",
                                    part.vertices.size(), " vertices, or they do not ascend below ",
                                    num_vertices));
  }
  if (part.coefficients.size() != static_cast<size_t>(part.basis.num_components) ||
      !AscendsBelow(part.coefficients, num_coefficients)) {
    return RefuseParts(absl::StrCat("a part has ", part.coefficients.size(), " coefficients for ",
                                    part.basis.num_components,
                                    " components, or they do not ascend "
                                    "below ",
                                    num_coefficients));
  }
  return absl::OkStatus();
}

absl::Status CheckParts(const PartedBasisParameters& p) {
  if (p.parts.empty() || p.num_coefficients < 1) return RefuseParts("there is none");
  if (p.parts.size() == 1 && p.parts[0].vertices.empty()) {
    if (p.parts[0].basis.num_components == p.num_coefficients) return absl::OkStatus();
    return RefuseParts(absl::StrCat(p.parts[0].basis.num_components, " components for ",
                                    p.num_coefficients, " coefficients"));
  }
  const int64_t num_details = CountDetails(p);
  if (num_details % 3 != 0) return RefuseParts(absl::StrCat(num_details, " details"));
  const int num_vertices = static_cast<int>(num_details / 3);
  std::vector<char> has_vertex(num_vertices, 0), has_coefficient(p.num_coefficients, 0);
  for (const PartedBasisParameters::Part& part : p.parts) {
    PLEAT_RETURN_IF_ERROR(CheckPart(part, num_vertices, p.num_coefficients));
    for (const int v : part.vertices) {
      if (std::exchange(has_vertex[v], 1))
        return RefuseParts(absl::StrCat("vertex ", v, " is in two"));
    }
    for (const int c : part.coefficients) has_coefficient[c] = 1;
  }
  // As many places as vertices, and none twice: every vertex has a part.
  if (std::ranges::count(has_coefficient, 0) > 0) return RefuseParts("a coefficient moves no part");
  return absl::OkStatus();
}

}  // namespace

PartedBasisParameters PartedBasisParameters::Whole(DetailBasisParameters basis) {
  PartedBasisParameters parameters;
  parameters.num_coefficients = basis.num_components;
  parameters.parts.push_back({.vertices = {}, .coefficients = {}, .basis = std::move(basis)});
  return parameters;
}

absl::StatusOr<PartedBasis> PartedBasis::FromParameters(const PartedBasisParameters& parameters) {
  PLEAT_RETURN_IF_ERROR(CheckParts(parameters));
  PartedBasis basis;
  basis.num_details_ = static_cast<int>(CountDetails(parameters));
  basis.num_coefficients_ = parameters.num_coefficients;
  for (const PartedBasisParameters::Part& part : parameters.parts) {
    PLEAT_ASSIGN_OR_RETURN(DetailBasis own, DetailBasis::FromParameters(part.basis));
    basis.part_of_block_.insert(basis.part_of_block_.end(), own.num_blocks(), basis.num_parts());
    basis.parts_.push_back({part.vertices, part.coefficients, std::move(own), basis.num_blocks_});
    basis.num_blocks_ += basis.parts_.back().basis.num_blocks();
  }
  return basis;
}

PartedBasisParameters PartedBasis::parameters() const {
  PartedBasisParameters p;
  p.num_coefficients = num_coefficients_;
  for (const Part& part : parts_) {
    p.parts.push_back({part.vertices, part.coefficients, part.basis.parameters()});
  }
  return p;
}

size_t PartedBasis::memory_bytes() const {
  size_t bytes = part_of_block_.size() * sizeof(int);
  for (const Part& part : parts_) {
    bytes +=
        part.basis.memory_bytes() + (part.vertices.size() + part.coefficients.size()) * sizeof(int);
  }
  return bytes;
}

std::vector<int> PartedBasis::LaneVertices() const {
  if (is_whole()) return {};
  std::vector<int> lanes;
  for (const Part& part : parts_) {
    lanes.insert(lanes.end(), part.vertices.begin(), part.vertices.end());
    lanes.resize(static_cast<size_t>(part.first_block + part.basis.num_blocks()) * kLanes, -1);
  }
  return lanes;
}

Eigen::VectorXf PartedBasis::Mean() const {
  if (is_whole()) return parts_[0].basis.Mean();
  Eigen::VectorXf mean(num_details_);
  for (const Part& part : parts_) {
    const Eigen::VectorXf own = part.basis.Mean();
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      mean.segment<3>(3 * part.vertices[i]) = own.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
  }
  return mean;
}

Eigen::MatrixXd PartedBasis::Dense() const {
  if (is_whole()) return parts_[0].basis.Dense();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_details_, num_coefficients_);
  for (const Part& part : parts_) {
    const Eigen::MatrixXd own = part.basis.Dense();
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      const auto rows = own.middleRows<3>(3 * static_cast<Eigen::Index>(i));
      for (size_t c = 0; c < part.coefficients.size(); ++c) {
        dense.block<3, 1>(3 * part.vertices[i], part.coefficients[c]) =
            rows.col(static_cast<Eigen::Index>(c));
      }
    }
  }
  return dense;
}

void PartedBasis::SetCoefficients(const Eigen::Ref<const Eigen::VectorXf>& coefficients,
                                  Query* query) const {
  assert(coefficients.size() == num_coefficients_);
  query->parts.resize(parts_.size());
  if (is_whole()) {
    parts_[0].basis.SetCoefficients(coefficients, query->parts.data());
    return;
  }
  query->coefficients.resize(num_coefficients_);
  for (size_t p = 0; p < parts_.size(); ++p) {
    const std::vector<int>& taken = parts_[p].coefficients;
    const auto count = static_cast<Eigen::Index>(taken.size());
    for (Eigen::Index c = 0; c < count; ++c) query->coefficients[c] = coefficients[taken[c]];
    parts_[p].basis.SetCoefficients(query->coefficients.head(count), &query->parts[p]);
  }
}

void PartedBasis::ExpandBlocks(std::span<const Query* const> queries, int first_block,
                               int num_blocks, std::span<float* const> details) const {
  assert(queries.size() <= kMostTogether && queries.size() == details.size());
  std::array<const DetailBasis::Query*, kMostTogether> of_part{};
  std::array<float*, kMostTogether> targets{};
  for (int block = first_block; block < first_block + num_blocks;) {
    const int number = part_of_block_[block];
    const Part& part = parts_[number];
    const int end = std::min(first_block + num_blocks, part.first_block + part.basis.num_blocks());
    for (size_t q = 0; q < queries.size(); ++q) {
      of_part[q] = &queries[q]->parts[number];
      targets[q] = details[q] + ptrdiff_t{DetailBasis::kBlockDetails} * (block - first_block);
    }
    part.basis.ExpandBlocks({of_part.data(), queries.size()}, block - part.first_block, end - block,
                            {targets.data(), queries.size()});
    block = end;
  }
}

void PartedBasis::Expand(const Query& query, Eigen::Ref<Eigen::VectorXf> detail) const {
  assert(detail.size() == num_details_);
  if (is_whole()) {
    parts_[0].basis.Expand(query.parts[0], detail);
    return;
  }
  std::array<float, DetailBasis::kBlockDetails> block;
  const std::array<const Query*, 1> queries = {&query};
  const std::array<float*, 1> target = {block.data()};
  for (const Part& part : parts_) {
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      const size_t lane = i % kLanes;
      if (lane == 0) {
        ExpandBlocks(queries, part.first_block + static_cast<int>(i / kLanes), 1, target);
      }
      for (int axis = 0; axis < 3; ++axis) {
        detail[3 * part.vertices[i] + axis] = block[axis * kLanes + lane];
      }
    }
  }
}

}  // namespace pleat
