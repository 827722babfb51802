// Small synthetic data for the learner's tests.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "pleat/base/random.h"

namespace pleat {

// rows x cols standard normal numbers.
inline Eigen::MatrixXd RandomMatrix(int rows, int cols, uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd m(rows, cols);
  for (int c = 0; c < cols; ++c) {
    for (int r = 0; r < rows; ++r) m(r, c) = random.Normal();
  }
  return m;
}

// A smooth motion: `num_features` and `num_details` mixtures of four phases of one periodic motion
// that slowly changes. Same seed, same mixture; `begin` shifts the frames.
struct SyntheticMotion {
  Eigen::MatrixXd features;  // N x D_S
  Eigen::MatrixXd details;   // N x D_M
};

inline SyntheticMotion MakeSyntheticMotion(int num_frames, int num_features, int num_details,
                                           uint64_t seed, int begin = 0) {
  const Eigen::MatrixXd feature_mix = RandomMatrix(4, num_features, seed);
  const Eigen::MatrixXd detail_mix = RandomMatrix(6, num_details, seed + 1);
  SyntheticMotion motion;
  motion.features.resize(num_frames, num_features);
  motion.details.resize(num_frames, num_details);
  for (int t = 0; t < num_frames; ++t) {
    const double phase = .15 * (begin + t), drift = .02 * (begin + t);
    Eigen::RowVectorXd state(4);
    state << std::sin(phase), std::cos(phase), .3 * std::sin(2 * phase), .5 * std::sin(drift);
    Eigen::RowVectorXd bent(6);
    bent << state[0] * state[1], state[0] * state[0], state[3], state[1] + state[2], state[0],
        state[2] * state[3];
    motion.features.row(t) = .5 * state * feature_mix;
    motion.details.row(t) = 2 * bent * detail_mix;
  }
  return motion;
}

}  // namespace pleat
