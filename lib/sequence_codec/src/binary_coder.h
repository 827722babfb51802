// Adaptive binary arithmetic coding: one class codes and decodes, so that a model is written once.
// Range coder after Martin 1979 in its carry-less form; probabilities are integers, so both sides
// agree on every machine.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pleat {

class BinaryCoder {
 public:
  // Probabilities are in 1/65536; those of the models stay this far from 0 and 1.
  static constexpr int kOne = 1 << 16, kHalf = kOne / 2, kMinProbability = 16;
  // A decision costs at least log2(65536 / 65520) = 1/2839 bit: `bytes` of code cannot hold more
  // decisions of a model than this. It bounds what a decoder may allocate for them.
  static constexpr uint64_t kMaxDecisionsPerByte = 22'720;

  static BinaryCoder ForEncoding() { return BinaryCoder(false, {}); }
  // Reads `bytes`, which must outlive the coder.
  static BinaryCoder ForDecoding(std::string_view bytes) { return BinaryCoder(true, bytes); }

  bool decoding() const { return decoding_; }
  // The decoder went on behind the end of its bytes: what it returned is meaningless.
  bool overrun() const { return overrun_bytes_ > 4; }

  // Encodes `bit` and returns it, or returns the decoded one. probability: of a 1, 1 .. kOne - 1.
  int Code(int bit, int probability) {
    const uint32_t middle = low_ + static_cast<uint32_t>((static_cast<uint64_t>(high_ - low_) *
                                                          static_cast<uint32_t>(probability)) >>
                                                         16);
    if (decoding_) bit = code_ <= middle;
    if (bit) {
      high_ = middle;
    } else {
      low_ = middle + 1;
    }
    while (((low_ ^ high_) & 0xff000000u) == 0) Shift();
    return bit;
  }
  // `num_bits` equally likely bits, highest first; 0 .. 32.
  uint32_t CodeBits(uint32_t value, int num_bits);

  // Encoder only: the bytes. The coder must not be used after it.
  std::string Finish();

 private:
  BinaryCoder(bool decoding, std::string_view bytes);
  void Shift();
  uint8_t NextByte();

  bool decoding_;
  uint32_t low_ = 0, high_ = 0xffffffffu, code_ = 0;
  std::string_view input_;
  size_t offset_ = 0;
  int overrun_bytes_ = 0;
  std::string output_;
};

}  // namespace pleat
