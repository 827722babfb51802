// Residuals -> Draco bytes, faster than Draco's own encoder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pleat {

// Writes sequential Draco point clouds of three int32 attributes of one component without
// prediction, what EncodeDracoResiduals makes with Draco itself, in a quarter of its time. One per
// thread: it owns scratch memory, as large as it can get from the first frame on.
class ResidualWriter {
 public:
  // residuals: 3 x V. False when they are too large, or too few for their range: then Draco itself
  // finds a smaller form.
  bool Write(const Eigen::Matrix3Xi& residuals, std::string* bytes);

 private:
  // How a symbol changes the state of the coder.
  struct Step {
    uint32_t frequency = 0;   // of 2^precision_bits
    uint32_t cumulative = 0;  // frequencies of the symbols before
    uint32_t reciprocal = 0;  // division by the frequency: multiply and shift
    uint32_t shift = 0;
  };
  struct Channel {
    std::vector<uint32_t> symbols;  // V
    std::vector<uint32_t> counts;   // per symbol
    size_t num_used = 0;            // symbols that occur
    std::vector<Step> steps;        // per symbol
    std::vector<uint8_t> bytes;     // of the coder, last symbol first
    size_t num_bytes = 0;
    int bit_length = 0;      // what Draco calls the maximum bit length of the symbols
    int precision_bits = 0;  // follows from it
  };

  bool CountSymbols(const Eigen::Matrix3Xi& residuals, int c);
  static void Normalize(Channel* channel);
  void EncodeSymbols();
  static void AppendChannel(const Channel& channel, std::string* bytes);

  std::array<Channel, 3> channels_;
};

}  // namespace pleat
