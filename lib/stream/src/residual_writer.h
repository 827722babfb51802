// Writes residuals as Draco bytes, faster than Draco's own encoder does.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pleat {

// Writes sequential Draco point clouds with three int32 attributes of one component each and
// without prediction. EncodeDracoResiduals makes the same kind of cloud with Draco itself and takes
// four times as long. One writer serves one thread: it owns scratch memory.
class ResidualWriter {
 public:
  // Gives the scratch memory the size that frames of `num_vertices` can need at most.
  void Reserve(int num_vertices);

  // residuals: 3 x V. Returns false when they are too large, or too few for the number of different
  // values; Draco itself then finds a smaller form.
  bool Write(const Eigen::Matrix3Xi& residuals, std::string* bytes);

 private:
  // How one symbol changes the state of the coder.
  struct Step {
    uint32_t frequency = 0;   // all frequencies add up to 2^precision_bits
    uint32_t cumulative = 0;  // the sum of the frequencies of smaller symbols
    uint32_t reciprocal = 0;  // x / frequency = (x * reciprocal) >> shift
    uint32_t shift = 0;
  };
  // One coordinate of all residuals: the zigzag symbols, their statistics, and the coded bytes.
  struct Channel {
    std::vector<uint32_t> symbols;  // V
    std::vector<uint32_t> counts;   // one per possible symbol
    size_t num_used = 0;            // how many different symbols occur
    std::vector<Step> steps;        // one per possible symbol
    std::vector<uint8_t> bytes;     // the output of the coder, the last symbol first
    size_t num_bytes = 0;           // how much of `bytes` is used
    int bit_length = 0;             // what Draco calls the maximum bit length of the symbols
    int precision_bits = 0;         // follows from bit_length, here and in every decoder
  };

  bool CountSymbols(const Eigen::Matrix3Xi& residuals, int c);
  static void Normalize(Channel* channel);
  void EncodeSymbols();
  static void AppendChannel(const Channel& channel, std::string* bytes);

  std::array<Channel, 3> channels_;
};

}  // namespace pleat
