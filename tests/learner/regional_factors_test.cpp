#include "regional_factors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_data.h"

namespace pleat {
namespace {

// Sets that overlap, one of them in several scales; a column in none; rows that fill no chunk.
RegionalGpParameters MakeParameters(int num_rows) {
  RegionalGpParameters p;
  p.inputs = RandomMatrix(num_rows, 7, 1);
  p.regions.resize(3);
  p.regions[0] = {
      .scales = {{{0, 1, 2, 4, 5, 6}, .3, 1.5, .2}, {{0, 1}, .7, .5, 0}}, .bias = .25, .alpha = {}};
  p.regions[1] = {.scales = {{{0, 1, 2, 4, 5, 6}, .1, .8, .4}}, .bias = 0, .alpha = {}};
  p.regions[2] = {.scales = {{{1, 4}, .2, 2, .1}, {{0, 1}, .4, .3, .6}, {{6}, 1, 1, 0}},
                  .bias = 1,
                  .alpha = {}};
  // Sets that share columns, of which some are longer than their bound.
  for (RegionalGpParameters::Region& region : p.regions) {
    for (RegionalGpParameters::Scale& scale : region.scales) {
      if (scale.columns.size() == 2) scale.max_norm = .5;
    }
  }
  return p;
}

double ExpectedFactor(const RegionalGpParameters& p, size_t region, Eigen::Index n,
                      const Eigen::VectorXd& row) {
  double kernel = p.regions[region].bias;
  for (const RegionalGpParameters::Scale& scale : p.regions[region].scales) {
    double distance = 0, product = 0;
    const double norm = row(scale.columns).norm();
    const double factor = norm > scale.max_norm ? scale.max_norm / norm : 1;
    for (const int column : scale.columns) {
      distance += std::pow(factor * row[column] - p.inputs(n, column), 2);
      product += factor * row[column] * p.inputs(n, column);
    }
    kernel +=
        scale.amplitude * std::exp(-.5 * scale.inverse_width * distance) + scale.linear * product;
  }
  return kernel;
}

TEST(RegionalFactorsTest, AreTheKernelsOfAllRegionsOnEveryProcessor) {
  for (const int num_rows : {1, 16, 37}) {
    const RegionalGpParameters p = MakeParameters(num_rows);
    const RegionalFactors factors(p);
    const Eigen::VectorXd row = RandomMatrix(7, 1, 5);
    Eigen::VectorXd scratch(static_cast<Eigen::Index>(factors.scratch_size()));
    Eigen::VectorXf expected(3 * num_rows);
    factors.Compute(row.data(), scratch.data(), expected.data());
    for (int r = 0; r < 3; ++r) {
      for (int n = 0; n < num_rows; ++n) {
        EXPECT_NEAR(expected[r * num_rows + n], ExpectedFactor(p, r, n, row), 1e-6);
      }
    }
    for (const auto& [set, compute] : RegionalFactors::Variants()) {
      Eigen::VectorXf values(3 * num_rows);
      compute(factors, row.data(), scratch.data(), values.data());
      EXPECT_EQ(values, expected) << NameOf(set);
    }
  }
}

}  // namespace
}  // namespace pleat
