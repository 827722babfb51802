#include "binary_coder.h"

#include <utility>

namespace pleat {

BinaryCoder::BinaryCoder(bool decoding, std::string_view bytes)
    : decoding_(decoding), input_(bytes) {
  if (decoding_) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | NextByte();
  }
}

uint8_t BinaryCoder::NextByte() {
  if (offset_ < input_.size()) return static_cast<uint8_t>(input_[offset_++]);
  if (overrun_bytes_ <= 4) ++overrun_bytes_;
  return 0;
}

void BinaryCoder::Shift() {
  if (decoding_) {
    code_ = code_ << 8 | NextByte();
  } else {
    output_.push_back(static_cast<char>(high_ >> 24));
  }
  low_ <<= 8;
  high_ = high_ << 8 | 255;
}

uint32_t BinaryCoder::CodeBits(uint32_t value, int num_bits) {
  uint32_t result = 0;
  for (int i = num_bits - 1; i >= 0; --i) {
    result = result << 1 | static_cast<uint32_t>(Code(static_cast<int>(value >> i & 1), kHalf));
  }
  return result;
}

std::string BinaryCoder::Finish() {
  // The decoder reads zeros behind the end, and low and high differ in their first byte: that byte
  // of the first multiple of 2^24 at or above `low_` is enough.
  output_.push_back(static_cast<char>((low_ >> 24) + ((low_ & 0xffffffu) != 0)));
  return std::move(output_);
}

}  // namespace pleat
