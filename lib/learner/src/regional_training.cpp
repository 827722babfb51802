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
                          const ScorePca& pca, const RegionalBasisOptions& options) {
  RegionBasis result;
  for (Eigen::Index d = 0; d < region.weights.size(); ++d) {
    if (region.weights[d] != 0) result.rows.push_back(d);
  }
  const Eigen::MatrixXd share =
      region.weights(result.rows).asDiagonal() * details.basis(result.rows, Eigen::all);
  result.basis = pca.Compute(share, options.max_region_components, options.region_energy).basis;
  result.outputs = details.scores * (share.transpose() * result.basis);
  result.outputs.rowwise() -= result.outputs.colwise().mean().eval();
  return result;
}

// The vertices of every part: those in which a region has the largest share, regions without any
// left out. One part without a list when rows are not those of vertices.
std::vector<std::vector<int>> PartsOf(const std::vector<DetailRegion>& regions,
                                      Eigen::Index num_rows) {
  if (num_rows % 3 != 0 || num_rows != regions[0].weights.size()) return {{}};
  std::vector<std::vector<int>> parts(regions.size());
  for (int v = 0; v < num_rows / 3; ++v) {
    size_t largest = 0;
    for (size_t r = 1; r < regions.size(); ++r) {
      if (regions[r].weights[3 * v] > regions[largest].weights[3 * v]) largest = r;
    }
    parts[largest].push_back(v);
  }
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

// The coarsest steps of a part's basis, as for the basis of other learners: rounding to a step s
// errs by s / sqrt(12) RMS in each detail, times the component's score.
Eigen::VectorXd PartSteps(const ScorePca::Components& part, double rounding, double detail_rms) {
  const Eigen::VectorXd rms = part.rms.cwiseMax(1e-300);
  return rounding * std::sqrt(12.0) * detail_rms * rms.cwiseInverse();
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
  part.components = pca.Compute(own, caps.max_part_components, caps.part_energy);
  const Eigen::MatrixXd& components = part.components.basis;
  PLEAT_ASSIGN_OR_RETURN(
      const DetailBasis rounded,
      DetailBasis::Quantize(mean(part.rows).cast<float>(), components,
                            PartSteps(part.components, options.rounding, detail_rms)));
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

// Adds the blocks that express the basis of a region in those of the parts. first_input: its first
// output of the regional GP; rows, basis: in the coordinates of the predictions.
void AddFold(const std::vector<PartBasis>& parts, int first_input,
             const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& basis,
             std::vector<CoefficientFoldBlock>* fold) {
  for (const PartBasis& part : parts) {
    std::vector<Eigen::Index> in_region, in_part;  // places of the rows that both have
    for (size_t r = 0, p = 0; r < rows.size() && p < part.rows.size();) {
      if (rows[r] < part.rows[p]) {
        ++r;
      } else if (rows[r] > part.rows[p]) {
        ++p;
      } else {
        in_region.push_back(static_cast<Eigen::Index>(r++));
        in_part.push_back(static_cast<Eigen::Index>(p++));
      }
    }
    if (in_region.empty()) continue;
    const Eigen::MatrixXd product = basis(in_region, Eigen::all).transpose() *
                                    part.components.basis(in_part, Eigen::all);
    fold->push_back({first_input, part.first_coefficient, product.cast<float>()});
  }
}

// Root mean square of the details, all entries, where scores are uncorrelated.
double DetailRms(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& scores) {
  const Eigen::VectorXd variances = (scores.rowwise() - scores.colwise().mean())
                                        .colwise()
                                        .squaredNorm()
                                        .transpose() /
                                    double(scores.rows());
  return std::sqrt((basis * variances.cwiseSqrt().asDiagonal()).squaredNorm() /
                   double(basis.rows()));
}

}  // namespace

absl::StatusOr<RegionalTraining> TrainRegional(
    const Eigen::MatrixXd& features, const PrincipalComponents& details,
    const Eigen::VectorXd& input_scales, const DetailModelOptions& options,
    const Progress& progress) {
  const ScorePca pca(details.scores);
  std::vector<GpRegion> regions;
  std::vector<RegionBasis> bases;
  for (const DetailRegion& region : options.regions) {
    bases.push_back(BasisOfRegion(region, details, pca, options.regional_basis));
    regions.push_back({region.feature_sets, std::move(bases.back().outputs)});
    PLEAT_RETURN_IF_ERROR(progress.Stage("regions", 0, .1).Report(
        static_cast<double>(bases.size()) / static_cast<double>(options.regions.size())));
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
  const double detail_rms = DetailRms(basis, details.scores);
  std::vector<PartBasis> parts;
  for (const std::vector<int>& vertices : PartsOf(options.regions, basis.rows())) {
    PLEAT_ASSIGN_OR_RETURN(PartBasis part, AddPart(vertices, Mapped(options, mean), basis, pca,
                                                   options, detail_rms, &training));
    parts.push_back(std::move(part));
  }
  for (size_t r = 0; r < bases.size(); ++r) {
    MapRegion(options, details.basis.rows(), &bases[r]);
    AddFold(parts, training.regional.regions[r].first_output, bases[r].rows, bases[r].basis,
            &training.fold);
  }
  return training;
}

}  // namespace pleat
