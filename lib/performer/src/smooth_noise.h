// A smooth random signal of time.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "pleat/base/random.h"

namespace pleat {

// The sum of five sines of unrelated frequencies, scaled so that values lie mostly within -1..1. It
// is smooth in all derivatives, so the motion has no jerks.
class SmoothNoise {
 public:
  SmoothNoise(Random* random, double mean_period_s) {
    for (Wave& wave : waves_) {
      wave.frequency = 2 * std::numbers::pi / (mean_period_s * random->Uniform(.55, 1.9));
      wave.phase = random->Uniform(0, 2 * std::numbers::pi);
    }
  }
  double operator()(double time_s) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.frequency * time_s + wave.phase);
    return sum / 2.4;
  }

 private:
  struct Wave {
    double frequency, phase;  // rad/s, rad
  };
  std::array<Wave, 5> waves_;
};

}  // namespace pleat
