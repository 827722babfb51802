#include "pleat/learner/parted_basis.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/allocation_counter.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumVertices = 70, kNumCoefficients = 9;

DetailBasisParameters Basis(int num_vertices, int num_components, int seed) {
  const Eigen::VectorXf mean = RandomMatrix(3 * num_vertices, 1, seed).col(0).cast<float>();
  return DetailBasis::Quantize(mean, RandomMatrix(3 * num_vertices, num_components, seed + 1),
                               Eigen::VectorXd::Constant(num_components, 1e-5))
      .value()
      .parameters();
}

// Three parts whose vertices are mixed, the last two of which share coefficients.
PartedBasisParameters Parameters() {
  PartedBasisParameters p;
  p.num_coefficients = kNumCoefficients;
  p.parts.resize(3);
  for (int v = 0; v < kNumVertices; ++v) p.parts[v % 7 < 4 ? 0 : 1 + v % 2].vertices.push_back(v);
  p.parts[0].coefficients = {0, 1, 2};
  p.parts[1].coefficients = {3, 4, 5, 6};
  p.parts[2].coefficients = {5, 6, 7, 8};
  for (int i = 0; i < 3; ++i) {
    p.parts[i].basis = Basis(static_cast<int>(p.parts[i].vertices.size()),
                             static_cast<int>(p.parts[i].coefficients.size()), 10 * i);
  }
  return p;
}

TEST(PartedBasisTest, TheDetailIsThatOfThePartOfEveryVertex) {
  const PartedBasisParameters p = Parameters();
  PLEAT_ASSERT_OK_AND_ASSIGN(const PartedBasis basis, PartedBasis::FromParameters(p));
  ASSERT_EQ(basis.num_details(), 3 * kNumVertices);
  const Eigen::VectorXf coefficients = RandomMatrix(kNumCoefficients, 1, 5).col(0).cast<float>();
  PartedBasis::Query query;
  basis.SetCoefficients(coefficients, &query);
  Eigen::VectorXf detail(basis.num_details());
  basis.Expand(query, detail);
  for (const PartedBasisParameters::Part& part : p.parts) {
    const DetailBasis own = DetailBasis::FromParameters(part.basis).value();
    DetailBasis::Query own_query;
    own.SetCoefficients(coefficients(part.coefficients), &own_query);
    Eigen::VectorXf expected(own.num_details());
    own.Expand(own_query, expected);
    for (size_t i = 0; i < part.vertices.size(); ++i) {
      EXPECT_EQ(detail.segment<3>(3 * part.vertices[i]),
                expected.segment<3>(3 * static_cast<Eigen::Index>(i)));
    }
  }
  const Eigen::VectorXd dense =
      basis.Mean().cast<double>() + basis.Dense() * coefficients.cast<double>();
  EXPECT_LT((detail.cast<double>() - dense).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(PartedBasisTest, BlocksHoldTheVerticesOfTheirLanes) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const PartedBasis basis, PartedBasis::FromParameters(Parameters()));
  const std::vector<int> lanes = basis.LaneVertices();
  ASSERT_EQ(lanes.size(), static_cast<size_t>(16 * basis.num_blocks()));
  std::vector<PartedBasis::Query> queries(5);
  std::vector<const PartedBasis::Query*> pointers;
  std::vector<std::vector<float>> blocks(5, std::vector<float>(48 * basis.num_blocks()));
  std::vector<float*> targets;
  for (int q = 0; q < 5; ++q) {
    basis.SetCoefficients(RandomMatrix(kNumCoefficients, 1, 20 + q).col(0).cast<float>(),
                          &queries[q]);
    pointers.push_back(&queries[q]);
    targets.push_back(blocks[q].data());
  }
  basis.ExpandBlocks(pointers, 0, basis.num_blocks(), targets);
  std::vector<int> seen;
  Eigen::VectorXf detail(basis.num_details());
  for (int q = 0; q < 5; ++q) {
    basis.Expand(queries[q], detail);
    for (size_t lane = 0; lane < lanes.size(); ++lane) {
      if (lanes[lane] < 0) continue;
      if (q == 0) seen.push_back(lanes[lane]);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(blocks[q][lane / 16 * 48 + axis * 16 + lane % 16],
                  detail[3 * lanes[lane] + axis]);
      }
    }
  }
  std::sort(seen.begin(), seen.end());
  std::vector<int> all(kNumVertices);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(seen, all);
}

TEST(PartedBasisTest, AWholeBasisIsTheBasisItself) {
  const DetailBasisParameters whole = Basis(20, 4, 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(const PartedBasis basis,
                             PartedBasis::FromParameters(PartedBasisParameters::Whole(whole)));
  const DetailBasis own = DetailBasis::FromParameters(whole).value();
  EXPECT_EQ(basis.num_coefficients(), 4);
  EXPECT_EQ(basis.num_blocks(), own.num_blocks());
  EXPECT_TRUE(basis.LaneVertices().empty());
  EXPECT_EQ(basis.Dense(), own.Dense());
  EXPECT_EQ(basis.Mean(), own.Mean());
}

TEST(PartedBasisTest, ParametersRoundTripAndQueriesDoNotAllocate) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const PartedBasis basis, PartedBasis::FromParameters(Parameters()));
  const PartedBasisParameters p = basis.parameters();
  ASSERT_EQ(p.parts.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(p.parts[i].vertices, Parameters().parts[i].vertices);
    EXPECT_EQ(p.parts[i].basis.values, Parameters().parts[i].basis.values);
  }
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  PartedBasis::Query query;
  const Eigen::VectorXf coefficients = RandomMatrix(kNumCoefficients, 1, 5).col(0).cast<float>();
  Eigen::VectorXf detail(basis.num_details());
  basis.SetCoefficients(coefficients, &query);
  basis.Expand(query, detail);
  const long before = NumAllocations();
  basis.SetCoefficients(coefficients, &query);
  basis.Expand(query, detail);
  EXPECT_EQ(NumAllocations(), before);
}

TEST(PartedBasisTest, RefusesPartsThatDoNotMakeAWhole) {
  const auto refused = [](auto change, const std::string& words) {
    PartedBasisParameters p = Parameters();
    change(p);
    EXPECT_THAT(PartedBasis::FromParameters(p),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](auto& p) { p.parts.clear(); }, "there is none");
  refused([](auto& p) { p.parts[0].vertices[1] = p.parts[0].vertices[0]; }, "do not ascend");
  refused([](auto& p) { p.parts[0].vertices.back() = kNumVertices; }, "ascend below 70");
  refused([](auto& p) { p.parts[0].vertices[0] = p.parts[1].vertices[0]; }, "");
  refused([](auto& p) { p.parts[1].vertices.pop_back(); }, "details for");
  refused([](auto& p) { p.parts[2].coefficients.back() = 9; }, "coefficients for");
  refused([](auto& p) { p.parts[2].coefficients.pop_back(); }, "3 coefficients for 4 components");
  refused([](auto& p) { ++p.num_coefficients; }, "moves no part");
  refused([](auto& p) { p.parts[2].basis.scales[0] = -std::numeric_limits<float>::infinity(); },
          "not finite");
  refused([](auto& p) { p.parts.resize(1), p.parts[0].vertices.clear(); }, "3 components for 9");
}

}  // namespace
}  // namespace pleat
