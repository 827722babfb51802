// A basis of details in planes of 8-bit integers: a query reads a quarter of the bytes that floats
// would need, and reading is what it spends its time on.
//
//   detail = mean + sum_p scale_p values_p c_{component_p}
//
// A component has one plane where that is exact enough and more where it is not: each plane holds
// what the one before has rounded off, in steps 254 times finer. The sum runs over integers, so
// that every processor gives the same detail.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/large_page_allocator.h"

namespace pleat {

// What a model file holds. D_M: number of details, P: number of planes.
struct DetailBasisParameters {
  using Planes = Eigen::Matrix<int8_t, Eigen::Dynamic, Eigen::Dynamic>;

  Eigen::VectorXf mean;         // D_M, unit of the details
  int num_components = 0;       // r
  std::vector<int> components;  // P, of each plane, ascending
  std::vector<float> scales;    // P, unit of the details per unit of the component
  Planes values;                // D_M x P, -127 to 127
};

class DetailBasis {
 public:
  // Details come in blocks of 48: those of 16 vertices, x of all, y of all, z of all. The last
  // block is filled up with zeros.
  static constexpr int kLanes = 16;
  static constexpr int kBlockDetails = 3 * kLanes;

  // Coefficients made ready for the sums.
  struct Query {
    std::vector<int16_t> weights;     // P, rounded up to pairs
    float unit = 0;                   // of the integer sums
    std::vector<float> coefficients;  // P, of the component of each plane
  };

  // Rounds `basis` (D_M x r): component k gets planes until its step (scale of its last plane) is
  // at most largest_steps[k], at most kMaxPlanes of them. kInvalidArgument when a number of mean or
  // basis is not finite as a float.
  static absl::StatusOr<DetailBasis> Quantize(
      const Eigen::Ref<const Eigen::VectorXf>& mean, const Eigen::Ref<const Eigen::MatrixXd>& basis,
      const Eigen::Ref<const Eigen::VectorXd>& largest_steps);
  static constexpr int kMaxPlanes = 3;

  // kInvalidArgument when sizes do not fit together, a component is out of range or out of order,
  // a value is -128 or a number not finite.
  static absl::StatusOr<DetailBasis> FromParameters(const DetailBasisParameters& parameters);
  DetailBasisParameters parameters() const;

  DetailBasis() = default;
  int num_details() const { return num_details_; }        // D_M
  int num_components() const { return num_components_; }  // r
  int num_planes() const { return static_cast<int>(components_.size()); }
  int num_blocks() const { return (num_details_ + kBlockDetails - 1) / kBlockDetails; }
  size_t memory_bytes() const;

  Eigen::VectorXf Mean() const;         // D_M
  Eigen::MatrixXd Dense() const;        // D_M x r
  Eigen::VectorXd FinestSteps() const;  // r: scale of each component's last plane, or infinity

  // coefficients: r; when one is not finite, all count as zero. No allocation after the first call.
  void SetCoefficients(const Eigen::Ref<const Eigen::VectorXf>& coefficients, Query* query) const;

  // Blocks first_block to first_block + num_blocks - 1 of the details of several queries, which
  // read the basis once. details[q] receives kBlockDetails * num_blocks values.
  void ExpandBlocks(std::span<const Query* const> queries, int first_block, int num_blocks,
                    std::span<float* const> details) const;

  // The whole detail (D_M) of one query, in the order of the rows.
  void Expand(const Query& query, Eigen::Ref<Eigen::VectorXf> detail) const;

 private:
  int num_pairs() const { return (num_planes() + 1) / 2; }
  size_t PlaceOf(int row, int plane) const;  // in values_

  int num_details_ = 0, num_components_ = 0;
  std::vector<int> components_;      // P
  bool has_one_plane_each_ = false;  // every component one: its number is that of the component
  std::vector<float> scales_;        // P
  std::vector<float> mean_;          // by blocks
  // By blocks, in a block by pairs of planes, in a pair row by row.
  std::vector<int8_t, LargePageAllocator<int8_t>> values_;
};

}  // namespace pleat
