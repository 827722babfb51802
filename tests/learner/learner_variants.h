// Every learner on small synthetic motions.
#pragma once

#include <numeric>
#include <vector>

#include "pleat/learner/detail_model.h"
#include "support/random_data.h"

namespace pleat {

struct LearnerVariant {
  const char* name;
  Learner learner;
  bool back_constraints;
};

inline constexpr LearnerVariant kVariants[] = {{"Gp", Learner::kGp, false},
                                               {"Sgplvm", Learner::kSgplvm, false},
                                               {"BackConstrained", Learner::kSgplvm, true},
                                               {"Regional", Learner::kRegional, false},
                                               {"Ridge", Learner::kRidge, false}};

inline DetailModelOptions SmallOptions(Learner learner, bool back_constraints = true) {
  DetailModelOptions options;
  options.learner = learner;
  options.sgplvm.latent_dimension = 4;
  options.sgplvm.max_iterations = 40;
  options.sgplvm.back_constraints = back_constraints;
  return options;
}

// With two regions: the first half of features and details, and the second.
inline DetailModelOptions WithRegions(DetailModelOptions options, const SyntheticMotion& motion) {
  const int num_features = static_cast<int>(motion.features.cols());
  const Eigen::Index num_details = motion.details.cols();
  std::vector<int> all(num_features);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> first(all.begin(), all.begin() + num_features / 2);
  const std::vector<int> second(all.begin() + num_features / 2, all.end());
  const auto region = [&](Eigen::Index begin, Eigen::Index end, const std::vector<int>& own) {
    DetailRegion result;
    for (Eigen::Index row = begin; row < end; ++row) result.rows.push_back(static_cast<int>(row));
    result.weights = Eigen::VectorXd::Ones(end - begin);
    result.feature_sets = {all, own};
    return result;
  };
  const Eigen::Index half = num_details / 6 * 3;  // whole vertices
  options.regions = {region(0, half, first), region(half, num_details, second)};
  return options;
}

}  // namespace pleat
