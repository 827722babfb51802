#include "regional_training.h"

#include <gtest/gtest.h>

#include "learner_variants.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr int kFrames = 60, kFeatures = 10, kDetails = 36;

class RegionalTrainingTest : public testing::Test {
 protected:
  RegionalTrainingTest() {
    options_ = WithRegions(SmallOptions(Learner::kRegional), motion_);
    options_.rounding = 1e-4;
  }
  absl::StatusOr<RegionalTraining> Train() const {
    return TrainRegional(motion_.features, ComputePca(motion_.details),
                         Eigen::VectorXd::Ones(kFeatures), options_, {});
  }
  // The detail that the parts give when every region says its own coefficients exactly.
  Eigen::VectorXd Unfolded(const RegionalTraining& training, const Eigen::VectorXd& outputs) const {
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(training.basis.num_coefficients);
    for (const CoefficientFoldBlock& block : training.fold) {
      const Eigen::MatrixXd weights = block.Dense();
      const Eigen::VectorXd sums = weights * outputs.segment(block.first_input, weights.cols());
      Eigen::Index begin = 0;
      for (const CoefficientFoldBlock::Target& target : block.targets) {
        coefficients.segment(target.first_output, target.count) +=
            sums.segment(begin, target.count);
        begin += target.count;
      }
    }
    const PartedBasis basis = PartedBasis::FromParameters(training.basis).value();
    return basis.Mean().cast<double>() + basis.Dense() * coefficients;
  }

  const SyntheticMotion motion_ = MakeSyntheticMotion(kFrames, kFeatures, kDetails, 3);
  DetailModelOptions options_;
};

TEST_F(RegionalTrainingTest, RegionsAndPartsTogetherSayTheDetails) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining training, Train());
  EXPECT_EQ(training.basis.parts.size(), 2u);
  const RegionalGp gp = RegionalGp::FromParameters(training.regional).value();
  RegionalGp::Workspace workspace;
  Eigen::VectorXd outputs(gp.num_outputs());
  double square = 0;
  for (int t = 0; t < kFrames; ++t) {
    gp.Predict(motion_.features.row(t).transpose(), &workspace, outputs);
    square += (Unfolded(training, outputs) - motion_.details.row(t).transpose()).squaredNorm();
  }
  const double spread =
      (motion_.details.rowwise() - motion_.details.colwise().mean()).squaredNorm();
  EXPECT_LT(square, .005 * spread);
}

TEST_F(RegionalTrainingTest, ScoresBecomeTheCoefficientsThatSayTheDetailBest) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining training, Train());
  const PrincipalComponents details = ComputePca(motion_.details);
  const PartedBasis basis = PartedBasis::FromParameters(training.basis).value();
  for (const int t : {0, 31, 59}) {
    const Eigen::VectorXd coefficients =
        training.scores_to_coefficients * details.scores.row(t).transpose();
    const Eigen::VectorXd detail = basis.Mean().cast<double>() + basis.Dense() * coefficients;
    const Eigen::VectorXd truth = motion_.details.row(t).transpose();
    EXPECT_LT((detail - truth).norm(), .02 * truth.norm()) << t;
  }
}

TEST_F(RegionalTrainingTest, ARegionThatHardlyMovesAPartHasNoOutputsThere) {
  // The first region has a share of a millionth in the part of the second.
  DetailRegion& first = options_.regions[0];
  for (int row = static_cast<int>(first.rows.size()); row < kDetails; ++row) {
    first.rows.push_back(row);
  }
  first.weights.conservativeResize(kDetails);
  first.weights.tail(kDetails / 2).setConstant(1e-6);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining training, Train());
  ASSERT_EQ(training.fold.size(), 2u);
  EXPECT_EQ(training.fold[0].targets.size(), 1u);
  options_.regional_basis.fold_rest = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining all, Train());
  ASSERT_EQ(all.fold.size(), 2u);
  EXPECT_EQ(all.fold[0].targets.size(), 2u);
}

TEST_F(RegionalTrainingTest, OnlyTheFirstRegionsMakeParts) {
  // The same regions twice, each with half of the share.
  std::vector<DetailRegion> twice = options_.regions;
  twice.insert(twice.end(), options_.regions.begin(), options_.regions.end());
  for (DetailRegion& region : twice) region.weights *= .5;
  options_.regions = twice;
  options_.num_part_regions = 1;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining training, Train());
  ASSERT_EQ(training.basis.parts.size(), 1u);
  EXPECT_EQ(training.basis.parts[0].vertices.size(), static_cast<size_t>(kDetails / 3));
  EXPECT_EQ(training.regional.regions.size(), 4u);
}

TEST_F(RegionalTrainingTest, CapsAreKept) {
  options_.regional_basis.max_region_components = 2;
  options_.regional_basis.max_part_components = 3;
  options_.regions[1].max_components = 1;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalTraining training, Train());
  EXPECT_EQ(training.regional.regions[0].alpha.cols(), 2);
  EXPECT_EQ(training.regional.regions[1].alpha.cols(), 1);
  for (const PartedBasisParameters::Part& part : training.basis.parts) {
    EXPECT_LE(part.coefficients.size(), 3u);
  }
}

}  // namespace
}  // namespace pleat
