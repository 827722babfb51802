#include "pleat/learner/detail_basis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kBasisDetails = 151;  // three blocks and a part of a fourth
constexpr int kNumComponents = 7;

struct Truth {
  Eigen::VectorXf mean = RandomMatrix(kBasisDetails, 1, 1).cast<float>();
  Eigen::MatrixXd basis = RandomMatrix(kBasisDetails, kNumComponents, 2);
  Eigen::VectorXf coefficients = RandomMatrix(kNumComponents, 1, 3).cast<float>();
  Eigen::VectorXd detail = mean.cast<double>() + basis * coefficients.cast<double>();
};

DetailBasis Rounded(const Truth& truth, double largest_step) {
  return DetailBasis::Quantize(truth.mean, truth.basis,
                               Eigen::VectorXd::Constant(kNumComponents, largest_step))
      .value();
}

Eigen::VectorXf Expanded(const DetailBasis& basis, const Eigen::VectorXf& coefficients) {
  DetailBasis::Query query;
  basis.SetCoefficients(coefficients, &query);
  Eigen::VectorXf detail(basis.num_details());
  basis.Expand(query, detail);
  return detail;
}

TEST(DetailBasisTest, MorePlanesComeNearerToTheBasis) {
  const Truth truth;
  const double largest = truth.basis.cwiseAbs().maxCoeff();
  double bound = largest / 127 / 2 * 1.001;
  for (int planes = 1; planes <= DetailBasis::kMaxPlanes; ++planes) {
    const DetailBasis basis = Rounded(truth, 2.1 * bound);
    EXPECT_EQ(basis.num_planes(), planes * kNumComponents);
    EXPECT_LT((basis.Dense() - truth.basis).cwiseAbs().maxCoeff(), bound);
    EXPECT_LT(basis.FinestSteps().maxCoeff(), 2.1 * bound);
    bound /= 254;
  }
  EXPECT_EQ(Rounded(truth, 0).num_planes(), DetailBasis::kMaxPlanes * kNumComponents);
}

TEST(DetailBasisTest, ExpandsToTheDetail) {
  const Truth truth;
  const Eigen::VectorXf detail = Expanded(Rounded(truth, 0), truth.coefficients);
  // Weights of 16 bits: each plane errs by half of a 32767th of the largest product.
  EXPECT_LT((detail.cast<double>() - truth.detail).cwiseAbs().maxCoeff(),
            1e-4 * truth.detail.cwiseAbs().maxCoeff());
}

// Details that fill no block, one block, and one more than a block.
TEST(DetailBasisTest, AnyNumberOfDetailsAndComponentsIsExpanded) {
  for (const int num_details : {1, 3, 47, 48, 49, 96, 97}) {
    for (const int num_components : {1, 2, 5}) {
      const Eigen::VectorXf mean = RandomMatrix(num_details, 1, 1).cast<float>();
      const Eigen::MatrixXd columns = RandomMatrix(num_details, num_components, 2);
      PLEAT_ASSERT_OK_AND_ASSIGN(
          const DetailBasis basis,
          DetailBasis::Quantize(mean, columns, Eigen::VectorXd::Zero(num_components)));
      EXPECT_EQ(basis.num_details(), num_details);
      EXPECT_EQ(basis.num_components(), num_components);
      EXPECT_EQ(basis.num_blocks(), (num_details + 47) / 48);
      EXPECT_GE(basis.memory_bytes(), static_cast<size_t>(num_details * basis.num_planes()));
      for (int k = 0; k < num_components; ++k) {
        // One component alone is its column, whatever its sign and size.
        for (const float size : {-3.f, 1e-20f, 1e20f}) {
          const Eigen::VectorXf detail =
              Expanded(basis, size * Eigen::VectorXf::Unit(num_components, k));
          const Eigen::VectorXd expected = mean.cast<double>() + double(size) * columns.col(k);
          EXPECT_LT((detail.cast<double>() - expected).cwiseAbs().maxCoeff(),
                    1e-4 * expected.cwiseAbs().maxCoeff());
        }
      }
    }
  }
}

TEST(DetailBasisTest, CoefficientsThatOverflowGiveTheMean) {
  const Truth truth;
  const DetailBasis basis = Rounded(truth, 0);
  Eigen::VectorXf coefficients = truth.coefficients;
  coefficients[2] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Expanded(basis, coefficients), truth.mean);
}

TEST(DetailBasisTest, ZeroCoefficientsGiveTheMean) {
  const Truth truth;
  const DetailBasis basis = Rounded(truth, 0);
  EXPECT_EQ(basis.Mean(), truth.mean);
  EXPECT_EQ(Expanded(basis, Eigen::VectorXf::Zero(kNumComponents)), truth.mean);
}

TEST(DetailBasisTest, AComponentOfZerosNeedsNoPlane) {
  Truth truth;
  truth.basis.col(3).setZero();
  const DetailBasis basis = Rounded(truth, 1);
  EXPECT_EQ(basis.num_planes(), kNumComponents - 1);
  EXPECT_TRUE(basis.Dense().col(3).isZero());
  EXPECT_EQ(basis.FinestSteps()[3], std::numeric_limits<double>::infinity());
}

TEST(DetailBasisTest, QueriesTogetherGiveTheBitsOfEachAlone) {
  const Truth truth;
  const DetailBasis basis = Rounded(truth, 0);
  constexpr int kNumQueries = 11;  // more than one pass takes
  std::array<DetailBasis::Query, kNumQueries> queries;
  std::array<const DetailBasis::Query*, kNumQueries> pointers;
  std::array<std::array<float, 2 * DetailBasis::kBlockDetails>, kNumQueries> together;
  std::array<float*, kNumQueries> targets;
  for (int q = 0; q < kNumQueries; ++q) {
    basis.SetCoefficients(RandomMatrix(kNumComponents, 1, 10 + q).cast<float>(), &queries[q]);
    pointers[q] = &queries[q];
    targets[q] = together[q].data();
  }
  basis.ExpandBlocks(pointers, 1, 2, targets);
  for (int q = 0; q < kNumQueries; ++q) {
    Eigen::VectorXf alone(kBasisDetails);
    basis.Expand(queries[q], alone);
    for (int block = 0; block < 2; ++block) {
      for (int lane = 0; lane < DetailBasis::kLanes; ++lane) {
        for (int axis = 0; axis < 3; ++axis) {
          const int row = (1 + block) * DetailBasis::kBlockDetails + 3 * lane + axis;
          EXPECT_EQ(
              together[q][block * DetailBasis::kBlockDetails + axis * DetailBasis::kLanes + lane],
              alone[row]);
        }
      }
    }
  }
}

TEST(DetailBasisTest, SumsDoNotOverflow) {
  // Many components with the same large product: the sum of the weights decides the unit.
  constexpr int kMany = 900;
  const DetailBasis basis =
      DetailBasis::Quantize(Eigen::VectorXf::Zero(5), Eigen::MatrixXd::Ones(5, kMany),
                            Eigen::VectorXd::Constant(kMany, 1))
          .value();
  for (const float sign : {1.f, -1.f}) {
    const Eigen::VectorXf detail = Expanded(basis, Eigen::VectorXf::Constant(kMany, sign));
    EXPECT_LT((detail.array() - sign * kMany).abs().maxCoeff(), .05 * kMany);
  }
  EXPECT_TRUE(Expanded(basis, Eigen::VectorXf::Constant(kMany, 1e34f)).allFinite());
}

TEST(DetailBasisTest, ParametersGiveTheSameBasis) {
  const Truth truth;
  const DetailBasis basis = Rounded(truth, 1e-4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailBasis again,
                             DetailBasis::FromParameters(basis.parameters()));
  EXPECT_EQ(again.Dense(), basis.Dense());
  EXPECT_EQ(Expanded(again, truth.coefficients), Expanded(basis, truth.coefficients));
}

TEST(DetailBasisTest, RefusesWhatDoesNotFit) {
  const Truth truth;
  const auto refused = [&](auto change, const std::string& words) {
    DetailBasisParameters p = Rounded(truth, 1).parameters();
    change(p);
    EXPECT_THAT(DetailBasis::FromParameters(p),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](auto& p) { p = {}; }, "no details");
  refused([](auto& p) { p.values.conservativeResize(12, p.values.cols()); }, "planes are 12");
  refused([](auto& p) { p.scales.pop_back(); }, "6 scales");
  refused([](auto& p) { std::swap(p.components[1], p.components[2]); }, "do not ascend");
  refused([](auto& p) { p.components[0] = -1; }, "do not ascend");
  refused([](auto& p) { p.components.back() = kNumComponents; }, "do not ascend below 7");
  refused([](auto& p) { p.mean[2] = std::nanf(""); }, "mean is not finite");
  refused([](auto& p) { p.scales[2] = std::numeric_limits<float>::infinity(); }, "scale");
  refused([](auto& p) { p.values(3, 1) = -128; }, "-128");
  refused([](auto& p) { p.num_components = 2; }, "7 planes for 2");

  Eigen::MatrixXd hole = truth.basis;
  for (const double wrong : {std::nan(""), 1e300}) {
    hole(5, 2) = wrong;
    EXPECT_THAT(
        DetailBasis::Quantize(truth.mean, hole, Eigen::VectorXd::Ones(kNumComponents)).status(),
        HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("finite")));
  }
  EXPECT_THAT(DetailBasis::Quantize(Eigen::VectorXf(), Eigen::MatrixXd::Zero(0, 3),
                                    Eigen::VectorXd::Ones(3))
                  .status(),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no details")));
}

}  // namespace
}  // namespace pleat
