// Adaptive models of integers: several contexts predict every binary decision and a small online
// logistic regression mixes them (Mahoney 2005, "Adaptive weighing of context models"). Integer
// arithmetic only.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "binary_coder.h"

namespace pleat {

// ln(p / (1 - p)) in 1/256, of p in 1/4096; the inverse gives 1/65536.
struct LogisticTables {
  std::array<int16_t, 4096> stretch;
  std::array<uint16_t, 4096> squash;  // of x + 2048
  static const LogisticTables& Get();
};

// The probability of one decision in one context, learned at two speeds.
struct AdaptiveBit {
  uint16_t slow = BinaryCoder::kHalf, fast = BinaryCoder::kHalf;
  uint8_t count = 0;

  void Learn(int bit);
};

// Integers in `kNumContexts` contexts each. One object per kind of number and direction.
template <int kNumContexts>
class IntegerModel {
 public:
  using Contexts = std::array<int, kNumContexts>;

  // context_counts: how many values every context has; num_sets: of mixing weights.
  IntegerModel(const Contexts& context_counts, int num_sets)
      : tables_(LogisticTables::Get()),
        weights_(static_cast<size_t>(num_sets) * kNumNodes, Weights(InitialWeight())) {
    for (int i = 0; i < kNumContexts; ++i) {
      bits_[i].resize(static_cast<size_t>(context_counts[i]) * kNumNodes);
    }
  }

  // |value| < 2^28. `set` chooses the mixing weights.
  int CodeSigned(BinaryCoder* coder, int value, const Contexts& contexts, int set) {
    const int magnitude = CodeUnsigned(coder, std::abs(value), contexts, set);
    if (magnitude == 0) return 0;
    return coder->Code(value < 0, BinaryCoder::kHalf) ? -magnitude : magnitude;
  }

  int CodeUnsigned(BinaryCoder* coder, int value, const Contexts& contexts, int set) {
    AdaptiveBit* slots[kNumContexts];
    for (int i = 0; i < kNumContexts; ++i) {
      slots[i] = bits_[i].data() + static_cast<size_t>(contexts[i]) * kNumNodes;
    }
    Weights* weights = weights_.data() + static_cast<size_t>(set) * kNumNodes;
    for (int k = 0; k < kNumUnary; ++k) {  // is it more than k?
      if (!CodeDecision(coder, value > k, k, slots, weights)) return k;
    }
    const uint32_t rest = static_cast<uint32_t>(value - kNumUnary) + 1;  // Elias gamma
    int num_bits = 0;
    while (num_bits < kMaxBits &&
           CodeDecision(coder, rest >> (num_bits + 1) != 0, kNumUnary + std::min(num_bits, 15),
                        slots, weights)) {
      ++num_bits;
    }
    const uint32_t low = coder->CodeBits(rest & ((1u << num_bits) - 1), num_bits);
    return static_cast<int>((1u << num_bits) + low - 1) + kNumUnary;
  }

 private:
  static constexpr int kNumUnary = 14, kNumNodes = kNumUnary + 16, kMaxBits = 28;
  using WeightArray = std::array<int32_t, 2 * kNumContexts>;
  struct Weights {
    WeightArray w;
    explicit Weights(int32_t initial) { w.fill(initial); }
  };
  static constexpr int32_t InitialWeight() { return 52'000 / kNumContexts; }  // in 1/65536

  int CodeDecision(BinaryCoder* coder, int bit, int node, AdaptiveBit* const* slots,
                   Weights* weights) {
    WeightArray& w = weights[node].w;
    std::array<int32_t, 2 * kNumContexts> inputs;
    int64_t dot = 0;
    for (int i = 0; i < kNumContexts; ++i) {
      const AdaptiveBit& slot = slots[i][node];
      inputs[2 * i] = tables_.stretch[slot.slow >> 4];
      inputs[2 * i + 1] = tables_.stretch[slot.fast >> 4];
      dot += static_cast<int64_t>(w[2 * i]) * inputs[2 * i];
      dot += static_cast<int64_t>(w[2 * i + 1]) * inputs[2 * i + 1];
    }
    const int x = static_cast<int>(std::clamp<int64_t>(dot >> 16, -2047, 2047));
    const int probability = tables_.squash[x + 2048];
    bit = coder->Code(bit, probability);
    const int error = (bit << 16) - probability;
    for (int i = 0; i < 2 * kNumContexts; ++i) {
      w[i] += static_cast<int32_t>((static_cast<int64_t>(error) * inputs[i] + (1 << 15)) >> 16);
      w[i] = std::clamp(w[i], -(1 << 24), 1 << 24);
    }
    for (int i = 0; i < kNumContexts; ++i) slots[i][node].Learn(bit);
    return bit;
  }

  const LogisticTables& tables_;
  std::array<std::vector<AdaptiveBit>, kNumContexts> bits_;
  std::vector<Weights> weights_;
};

// 0, 1, 2, .. 11 for growing magnitudes; `sixteenths` is a mean magnitude in 1/16.
inline constexpr int kNumMagnitudeClasses = 12;
inline constexpr std::array<int, kNumMagnitudeClasses - 1> kMagnitudeBounds = {
    1, 4, 7, 12, 18, 28, 42, 64, 104, 176, 400};
inline constexpr auto kMagnitudeClasses = [] {
  std::array<uint8_t, kMagnitudeBounds.back() + 1> classes{};
  for (int i = 0, level = 0; i <= kMagnitudeBounds.back(); ++i) {
    while (level < kNumMagnitudeClasses - 1 && i >= kMagnitudeBounds[level]) ++level;
    classes[i] = static_cast<uint8_t>(level);
  }
  return classes;
}();
inline int MagnitudeClass(int sixteenths) {
  return kMagnitudeClasses[std::min(sixteenths, kMagnitudeBounds.back())];
}
// Number of bits of |value|, at most 15.
int BitLengthClass(int value);

}  // namespace pleat
