// The order of the steps and why.
//
// 1. Region bases. Region R has the share W_R Y_M of the details (W_R diagonal, summing to 1 over
//    regions), and PCA gives it a basis V_R of its own. A basis of all details would leave out what
//    a small region does in few frames, whatever the learner knows about it.
// 2. Gaussian processes, one per region, which predict its coefficients c_R.
// 3. Parts. The detail is sum_R V_R c_R, in which a vertex between regions would read the bases of
//    all of them. So vertices are shared out to parts, by the region that has the largest share in
//    them; the details of a part have a basis U_p of their own, and V_R c_R is expressed in it:
//    c_p = sum_R U_p^T V_R c_R. These products are the blocks of the fold, which are applied once
//    per query, while a vertex reads one basis only.
//
// All bases are made from the scores of one fine basis of the details, so that the details of all
// frames are never needed at once (score_pca.h).
#include "regional_training.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pleat/base/status.h"
#include "score_pca.h"

namespace pleat {
namespace {

// A region's basis among the rows that it has a share in.
struct RegionBasis {
  std::vector<Eigen::Index> rows;
  Eigen::MatrixXd basis;    // rows x r_R, coordinates of Y_M
  Eigen::VectorXd rms;      // r_R, of the scores
  Eigen::MatrixXd outputs;  // N x r_R
};

Eigen::MatrixXd Mapped(const DetailModelOptions& options, const Eigen::MatrixXd& columns) {
  return options.output_map ? options.output_map(columns) : columns;
}

// Takes the basis to the coordinates of the predictions, in which a region may move every row.
void MapRegion(const DetailModelOptions& options, Eigen::Index num_rows, RegionBasis* region) {
  if (!options.output_map) return;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(num_rows, region->basis.cols());
  all(region->rows, Eigen::all) = region->basis;
  region->basis = options.output_map(all);
  region->rows.resize(static_cast<size_t>(region->basis.rows()));
  std::iota(region->rows.begin(), region->rows.end(), 0);
}

RegionBasis BasisOfRegion(const DetailRegion& region, const PrincipalComponents& details,
                          const ScorePca& pca, const RegionalBasisOptions& options,
                          double detail_rms) {
  RegionBasis result;
  result.rows.assign(region.rows.begin(), region.rows.end());
  const Eigen::MatrixXd share =
      region.weights.asDiagonal() * details.basis(result.rows, Eigen::all);
  const int max_components =
      region.max_components > 0 ? region.max_components : options.max_region_components;
  ScorePca::Components components =
      pca.Compute(share, max_components, options.region_rest * detail_rms);
  result.basis = std::move(components.basis);
  result.rms = std::move(components.rms);
  result.outputs = details.scores * (share.transpose() * result.basis);
  result.outputs.rowwise() -= result.outputs.colwise().mean().eval();
  return result;
}

// The vertices of every part: those in which a region of the first `num_regions` has the largest
// share, regions without any left out. One part without a list when rows are not those of vertices.
std::vector<std::vector<int>> PartsOf(const std::vector<DetailRegion>& regions, size_t num_regions,
                                      Eigen::Index num_details, Eigen::Index num_rows) {
  if (num_rows % 3 != 0 || num_rows != num_details) return {{}};
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(num_rows / 3);
  std::vector<size_t> part_of(static_cast<size_t>(num_rows / 3), 0);
  for (size_t r = 0; r < num_regions; ++r) {
    for (size_t i = 0; i < regions[r].rows.size(); ++i) {
      const int v = regions[r].rows[i] / 3;
      if (!(regions[r].weights[static_cast<Eigen::Index>(i)] > largest[v])) continue;
      largest[v] = regions[r].weights[static_cast<Eigen::Index>(i)];
      part_of[v] = r;
    }
  }
  std::vector<std::vector<int>> parts(num_regions);
  for (size_t v = 0; v < part_of.size(); ++v) parts[part_of[v]].push_back(static_cast<int>(v));
  std::erase_if(parts, [](const std::vector<int>& part) { return part.empty(); });
  return parts;
}

std::vector<Eigen::Index> RowsOf(const std::vector<int>& vertices, Eigen::Index num_rows) {
  std::vector<Eigen::Index> rows;
  for (const int v : vertices) rows.insert(rows.end(), {3 * v, 3 * v + 1, 3 * v + 2});
  if (!vertices.empty()) return rows;
  for (Eigen::Index row = 0; row < num_rows; ++row) rows.push_back(row);
  return rows;
}

// One part while it is made: which rows it holds, and their basis U_p.
struct PartBasis {
  std::vector<Eigen::Index> rows;
  ScorePca::Components components;
  int first_coefficient = 0;
};

// Adds a part of `vertices` to the basis of `training`. mean, basis: of the details of all rows.
absl::StatusOr<PartBasis> AddPart(const std::vector<int>& vertices, const Eigen::VectorXd& mean,
                                  const Eigen::MatrixXd& basis, const ScorePca& pca,
                                  const DetailModelOptions& options, double detail_rms,
                                  RegionalTraining* training) {
  const RegionalBasisOptions& caps = options.regional_basis;
  PartBasis part{RowsOf(vertices, mean.size()), {}, training->basis.num_coefficients};
  const Eigen::MatrixXd own = basis(part.rows, Eigen::all);
  part.components = pca.Compute(own, caps.max_part_components, caps.part_rest * detail_rms);
  const Eigen::MatrixXd& components = part.components.basis;
  PLEAT_ASSIGN_OR_RETURN(
      const DetailBasis rounded,
      DetailBasis::Quantize(mean(part.rows).cast<float>(), components,
                            LargestSteps(part.components.rms, detail_rms, options.rounding)));
  PartedBasisParameters::Part entry{vertices, {}, rounded.parameters()};
  for (int c = 0; c < components.cols() && !vertices.empty(); ++c) {
    entry.coefficients.push_back(part.first_coefficient + c);
  }
  training->basis.parts.push_back(std::move(entry));
  training->basis.num_coefficients += static_cast<int>(components.cols());
  Eigen::MatrixXd& to_coefficients = training->scores_to_coefficients;
  to_coefficients.conservativeResize(training->basis.num_coefficients, basis.cols());
  to_coefficients.bottomRows(components.cols()) = components.transpose() * own;
  return part;
}

// The rows that two ascending lists share, as places in either.
struct SharedRows {
  std::vector<Eigen::Index> in_first, in_second;
};

SharedRows FindSharedRows(const std::vector<Eigen::Index>& first,
                          const std::vector<Eigen::Index>& second) {
  SharedRows shared;
  for (size_t a = 0, b = 0; a < first.size() && b < second.size();) {
    if (first[a] < second[b]) {
      ++a;
    } else if (first[a] > second[b]) {
      ++b;
    } else {
      shared.in_first.push_back(static_cast<Eigen::Index>(a++));
      shared.in_second.push_back(static_cast<Eigen::Index>(b++));
    }
  }
  return shared;
}

// Adds the block that expresses the basis of a region in those of the parts. A region whose
// skinning weights have long tails moves far parts by next to nothing, a root mean square of less
// than fold_rest of that of all details, and has no outputs there. first_input: its first output of
// the regional GP.
absl::Status AddFold(const std::vector<PartBasis>& parts, int first_input,
                     const RegionBasis& region, double detail_rms,
                     const DetailModelOptions& options, std::vector<CoefficientFoldBlock>* fold) {
  const double smallest_rms = options.regional_basis.fold_rest * detail_rms;
  std::vector<CoefficientFoldBlock::Target> targets;
  Eigen::MatrixXd weights(0, region.basis.cols());
  double most_per_row = 0;  // coefficients of a part for each of its rows
  for (const PartBasis& part : parts) {
    const SharedRows shared = FindSharedRows(region.rows, part.rows);
    if (shared.in_first.empty()) continue;
    const Eigen::MatrixXd moved = region.basis(shared.in_first, Eigen::all);
    const double square = (moved * region.rms.asDiagonal()).squaredNorm();
    if (square < smallest_rms * smallest_rms * double(part.rows.size())) continue;
    const Eigen::MatrixXd& basis = part.components.basis;
    targets.push_back({part.first_coefficient, static_cast<int>(basis.cols())});
    weights.conservativeResize(weights.rows() + basis.cols(), Eigen::NoChange);
    weights.bottomRows(basis.cols()) = basis(shared.in_second, Eigen::all).transpose() * moved;
    most_per_row =
        std::max(most_per_row, double(basis.cols()) / static_cast<double>(part.rows.size()));
  }
  if (targets.empty()) return absl::OkStatus();
  // An error of the coefficients spreads over more rows than there are coefficients.
  const Eigen::VectorXd steps =
      LargestSteps(region.rms, detail_rms / std::sqrt(most_per_row), options.rounding);
  PLEAT_ASSIGN_OR_RETURN(
      CoefficientFoldBlock block,
      CoefficientFoldBlock::Round(first_input, std::move(targets), weights, steps));
  fold->push_back(std::move(block));
  return absl::OkStatus();
}

// Root mean squares of the scores around their means.
Eigen::VectorXd ScoreRms(const Eigen::MatrixXd& scores) {
  const Eigen::VectorXd variances =
      (scores.rowwise() - scores.colwise().mean()).colwise().squaredNorm().transpose() /
      double(scores.rows());
  return variances.cwiseSqrt();
}

}  // namespace

absl::StatusOr<RegionalTraining> TrainRegional(const Eigen::MatrixXd& features,
                                               const PrincipalComponents& details,
                                               const Eigen::VectorXd& input_scales,
                                               const DetailModelOptions& options,
                                               const Progress& progress) {
  const ScorePca pca(details.scores);
  const Eigen::VectorXd score_rms = ScoreRms(details.scores);
  const double own_rms = DetailRms(details.basis, score_rms);
  std::vector<GpRegion> regions;
  std::vector<RegionBasis> bases;
  for (const DetailRegion& region : options.regions) {
    bases.push_back(BasisOfRegion(region, details, pca, options.regional_basis, own_rms));
    regions.push_back({region.feature_sets, std::move(bases.back().outputs)});
    PLEAT_RETURN_IF_ERROR(progress.Stage("regions", 0, .1)
                              .Report(static_cast<double>(bases.size()) /
                                      static_cast<double>(options.regions.size())));
  }
  RegionalGpOptions gp_options = options.regional;
  gp_options.input_scales.setOnes(features.cols());
  gp_options.input_scales.head(input_scales.size()) = input_scales;
  PLEAT_ASSIGN_OR_RETURN(
      const RegionalGp gp,
      RegionalGp::Train(features, regions, gp_options, progress.Stage("regions", .1, .95)));

  RegionalTraining training;
  training.regional = gp.parameters();
  const Eigen::VectorXd mean =
      details.mean + details.basis * details.scores.colwise().mean().transpose();
  const Eigen::MatrixXd basis = Mapped(options, details.basis);
  const double detail_rms = DetailRms(basis, score_rms);
  std::vector<PartBasis> parts;
  const size_t num_part_regions =
      options.num_part_regions > 0 ? options.num_part_regions : options.regions.size();
  for (const std::vector<int>& vertices :
       PartsOf(options.regions, num_part_regions, details.basis.rows(), basis.rows())) {
    PLEAT_ASSIGN_OR_RETURN(PartBasis part, AddPart(vertices, Mapped(options, mean), basis, pca,
                                                   options, detail_rms, &training));
    parts.push_back(std::move(part));
  }
  for (size_t r = 0; r < bases.size(); ++r) {
    MapRegion(options, details.basis.rows(), &bases[r]);
    PLEAT_RETURN_IF_ERROR(AddFold(parts, training.regional.regions[r].first_output, bases[r],
                                  detail_rms, options, &training.fold));
  }
  return training;
}

}  // namespace pleat
