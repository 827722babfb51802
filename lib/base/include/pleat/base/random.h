// A seeded random source whose bits are the same on every platform and standard library, unlike
// those of the distributions of <random>.
#pragma once

#include <cstdint>

namespace pleat {

// The generator xoshiro256** (Blackman and Vigna 2018), seeded through splitmix64. Not for secrets,
// and not for two threads at once.
class Random {
 public:
  explicit Random(uint64_t seed);

  uint64_t NextBits();                      // 64 uniform bits
  double Uniform();                         // in [0, 1)
  double Uniform(double low, double high);  // in [low, high)
  int UniformInt(int count);                // in [0, count); count > 0
  double Normal();                          // mean 0, variance 1 (Box-Muller)

 private:
  uint64_t state_[4];
};

}  // namespace pleat
