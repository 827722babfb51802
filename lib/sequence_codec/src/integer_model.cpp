#include "integer_model.h"

#include <bit>

namespace pleat {
namespace {

// How far a probability moves towards the last bit, in 1/65536: 1 / (n + 1.5) with a floor.
struct Rates {
  std::array<uint16_t, 256> slow, fast;
  Rates() {
    for (int n = 0; n < 256; ++n) {
      const int rate = 131'072 / (2 * n + 3);
      slow[n] = static_cast<uint16_t>(std::max(rate, 65'536 / 250));
      fast[n] = static_cast<uint16_t>(std::max(rate, 65'536 / 30));
    }
  }
};

}  // namespace

const LogisticTables& LogisticTables::Get() {
  // By products and quotients of doubles alone: the same integers on every machine.
  static const LogisticTables tables = [] {
    LogisticTables result;
    constexpr double kStep = 0.99610136947011749;  // exp(-1/256)
    double falling = 1;                            // exp(-x / 256)
    for (int x = 0; x < 2048; ++x, falling *= kStep) {
      const int upper = static_cast<int>(65'536 / (1 + falling) + 0.5);
      const int clamped = std::min(upper, BinaryCoder::kOne - BinaryCoder::kMinProbability);
      result.squash[2048 + x] = static_cast<uint16_t>(clamped);
      result.squash[2048 - x] = static_cast<uint16_t>(BinaryCoder::kOne - clamped);
    }
    result.squash[0] = result.squash[1];
    int x = 0;
    for (int p = 0; p < 4096; ++p) {  // the x whose squash reaches the middle of [p, p + 1)
      while (x < 4095 && result.squash[x] < p * 16 + 8) ++x;
      result.stretch[p] = static_cast<int16_t>(x - 2048);
    }
    return result;
  }();
  return tables;
}

void AdaptiveBit::Learn(int bit) {
  static const Rates rates;
  const int64_t target = bit ? 65'535 : 0;
  slow = static_cast<uint16_t>(slow + ((target - slow) * rates.slow[count] >> 16));
  fast = static_cast<uint16_t>(fast + ((target - fast) * rates.fast[count] >> 16));
  if (count < 255) ++count;
}

int BitLengthClass(int value) {
  return std::min(15, static_cast<int>(std::bit_width(static_cast<uint32_t>(std::abs(value)))));
}

}  // namespace pleat
