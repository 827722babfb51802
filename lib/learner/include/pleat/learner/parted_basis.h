// A basis of details in parts: every vertex belongs to one part of the body, and the details of a
// part are spanned by few components of its own, since a sleeve takes far fewer than the whole
// body.
//
//   detail of part p = mean_p + basis_p c(coefficients of p)
//
// A model without parts has one, which holds all vertices. Source: docs/method/learner.md#parts.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/learner/detail_basis.h"

namespace pleat {

// What a model file holds. D_M: number of details, three for each vertex; r: all coefficients.
struct PartedBasisParameters {
  struct Part {
    // The vertices of the part, ascending. Only the one part of a basis without parts has none
    // listed: it holds all rows in their order.
    std::vector<int> vertices;
    std::vector<int> coefficients;  // which of the r its components take, ascending
    DetailBasisParameters basis;    // of its 3 details for each vertex, in the order of `vertices`
  };
  int num_coefficients = 0;  // r
  std::vector<Part> parts;

  // One part of all rows, with as many coefficients as components.
  static PartedBasisParameters Whole(DetailBasisParameters basis);
};

class PartedBasis {
 public:
  static constexpr int kLanes = DetailBasis::kLanes;

  // Coefficients made ready for the sums.
  struct Query {
    std::vector<DetailBasis::Query> parts;
    Eigen::VectorXf coefficients;  // of one part
  };

  // kInvalidArgument when sizes do not fit together, when a vertex is missing or in two parts, a
  // coefficient is out of range or not used by any part, and what DetailBasis refuses.
  static absl::StatusOr<PartedBasis> FromParameters(const PartedBasisParameters& parameters);
  PartedBasisParameters parameters() const;

  int num_details() const { return num_details_; }            // D_M
  int num_coefficients() const { return num_coefficients_; }  // r
  int num_blocks() const { return num_blocks_; }
  int num_parts() const { return static_cast<int>(parts_.size()); }
  size_t memory_bytes() const;

  // Which vertex every lane of every block holds, kLanes x num_blocks() numbers; -1 where a block
  // is only filled up. Empty: the vertices follow each other in their order.
  std::vector<int> LaneVertices() const;

  Eigen::VectorXf Mean() const;   // D_M
  Eigen::MatrixXd Dense() const;  // D_M x r

  // coefficients: r, finite. No allocation after the first call.
  void SetCoefficients(const Eigen::Ref<const Eigen::VectorXf>& coefficients, Query* query) const;

  // Blocks first_block to first_block + num_blocks - 1 of the details of at most kMostTogether
  // queries, which read the basis once. details[q] receives kBlockDetails * num_blocks values.
  static constexpr size_t kMostTogether = 16;
  void ExpandBlocks(std::span<const Query* const> queries, int first_block, int num_blocks,
                    std::span<float* const> details) const;

  // The whole detail (D_M) of one query, in the order of the vertices.
  void Expand(const Query& query, Eigen::Ref<Eigen::VectorXf> detail) const;

 private:
  struct Part {
    std::vector<int> vertices, coefficients;
    DetailBasis basis;
    int first_block = 0;
  };
  // One part that holds all rows in their order.
  bool is_whole() const { return parts_.size() == 1 && parts_[0].vertices.empty(); }

  int num_details_ = 0, num_coefficients_ = 0, num_blocks_ = 0;
  std::vector<Part> parts_;
  std::vector<int> part_of_block_;
};

}  // namespace pleat
