// Signed differences between numbers of vertices or faces: their length is modeled, and the two
// bits below the highest one; the rest is noise. The last length tells how far numbers jump.
#pragma once

#include <algorithm>

#include "integer_model.h"

namespace pleat {

class NumberDifference {
 public:
  static constexpr int kDamaged = 1 << 30;  // beyond every number

  // |delta| < 2^27; context: 0 .. 15. Damaged code gives kDamaged.
  int Code(BinaryCoder* coder, int delta, int context) {
    const int zigzag = delta < 0 ? -2 * delta - 1 : 2 * delta;
    int length = 0;
    while (zigzag >> length != 0) ++length;
    length = lengths_.CodeUnsigned(coder, length, {context * 16 + last_length_, last_length_}, 0);
    if (length > 28) return kDamaged;
    last_length_ = std::min(length, 15);
    if (length <= 1) return length == 0 ? 0 : -1;
    const int num_modeled = std::min(length - 1, 2), num_raw = length - 1 - num_modeled;
    const int place = std::min(length, 19);
    int high = zigzag >> num_raw & ((1 << num_modeled) - 1);
    high = mantissas_.CodeUnsigned(coder, high, {place * 8 + num_modeled, place}, 0);
    if (high >= 1 << num_modeled) return kDamaged;
    const int raw = static_cast<int>(
        coder->CodeBits(static_cast<uint32_t>(zigzag) & ((1u << num_raw) - 1), num_raw));
    const int decoded = 1 << (length - 1) | high << num_raw | raw;
    return decoded & 1 ? -(decoded + 1) / 2 : decoded / 2;
  }

 private:
  IntegerModel<2> lengths_{{16 * 16, 16}, 1};
  IntegerModel<2> mantissas_{{20 * 8, 20}, 1};
  int last_length_ = 0;
};

}  // namespace pleat
