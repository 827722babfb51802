// Bitstream: Draco bitstream specification (google.github.io/draco/spec), sections "Draco header",
// "Sequential decoder", "Symbol decoding" and "rANS decoding". Coder: J. Duda, Asymmetric numeral
// systems (2013), the range variant. Division by multiplication: T. Granlund, P. Montgomery,
// Division by invariant integers using multiplication (PLDI 1994), theorem 4.2.
//
// The work on a frame: turn residuals into symbols and count them, scale the counts to frequencies
// that add up to a power of two, run the coder over the symbols, and write header, frequencies and
// coded bytes. The coder is a stack: it takes the symbols from last to first, and the decoder,
// which reads the bytes from their end, gets them from first to last. The order of the bytes, the
// scaling of the frequencies and the widths below are those of Draco's decoder and cannot be chosen
// freely; only the way to the frequencies can.
#include "residual_writer.h"

#include <algorithm>
#include <bit>

namespace pleat {
namespace {

// Symbols that are larger come from cuts, where a key frame is cheaper anyway.
constexpr uint32_t kMaxSymbol = 1 << 14;
// With fewer values per different symbol the table of frequencies costs too much. Draco's other
// form is then smaller: it codes the number of bits of every value, and the bits as they are.
constexpr size_t kMinValuesPerSymbol = 16;
constexpr int kMinPrecisionBits = 12, kMaxPrecisionBits = 20;
// Between two symbols the state of the coder is in [4, 1024) times 2^precision_bits.
constexpr uint32_t kLowestState = 4;
constexpr int kStateBits = 10;

constexpr uint8_t kGeneric = 4, kInt32 = 5, kIntegerDecoder = 1, kRawSymbols = 1;
constexpr uint8_t kNoPrediction = 0xfe;

void AppendVarint(uint64_t value, std::string* bytes) {
  for (; value >= 0x80; value >>= 7) bytes->push_back(static_cast<char>((value & 0x7f) | 0x80));
  bytes->push_back(static_cast<char>(value));
}

void AppendLittleEndian(uint32_t value, int num_bytes, std::string* bytes) {
  for (int i = 0; i < num_bytes; ++i) bytes->push_back(static_cast<char>(value >> (8 * i)));
}

// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
uint32_t ZigZag(int value) {
  return (static_cast<uint32_t>(value) << 1) ^ static_cast<uint32_t>(value >> 31);
}

// A symbol takes less than three bytes, the last state four.
size_t MostBytes(size_t num_symbols) { return 3 * num_symbols + 8; }

}  // namespace

void ResidualWriter::Reserve(int num_vertices) {
  const auto num_symbols = static_cast<size_t>(num_vertices);
  for (Channel& channel : channels_) {
    channel.symbols.reserve(num_symbols);
    channel.counts.reserve(kMaxSymbol + 1);
    channel.steps.reserve(kMaxSymbol + 1);
    channel.bytes.reserve(MostBytes(num_symbols));
  }
}

bool ResidualWriter::CountSymbols(const Eigen::Matrix3Xi& residuals, int c) {
  Channel& channel = channels_[c];
  const Eigen::Index count = residuals.cols();
  channel.symbols.resize(count);
  uint32_t largest = 0;
  const int* residual = residuals.data() + c;
  for (Eigen::Index i = 0; i < count; ++i) {
    channel.symbols[i] = ZigZag(residual[3 * i]);
    largest = std::max(largest, channel.symbols[i]);
  }
  if (largest > kMaxSymbol) return false;
  channel.counts.assign(largest + 1, 0);
  for (const uint32_t symbol : channel.symbols) ++channel.counts[symbol];
  channel.num_used = channel.counts.size() - static_cast<size_t>(std::count(
                                                 channel.counts.begin(), channel.counts.end(), 0u));
  return channel.num_used * kMinValuesPerSymbol <= channel.symbols.size();
}

// Scales the counts to frequencies that add up to 2^precision_bits. A symbol that occurs must keep
// a frequency of at least 1, or it could not be coded.
void ResidualWriter::Normalize(Channel* channel) {
  const std::vector<uint32_t>& counts = channel->counts;
  channel->bit_length = static_cast<int>(std::bit_width(channel->num_used));
  channel->precision_bits =
      std::clamp(3 * channel->bit_length / 2, kMinPrecisionBits, kMaxPrecisionBits);
  const int64_t target = int64_t{1} << channel->precision_bits;
  const auto total = static_cast<int64_t>(channel->symbols.size());

  channel->steps.assign(counts.size(), Step());
  int64_t sum = 0, above_one = 0;
  size_t most_frequent = 0;
  for (size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] == 0) continue;
    const int64_t scaled = (int64_t{counts[s]} * target + total / 2) / total;
    channel->steps[s].frequency = static_cast<uint32_t>(std::max<int64_t>(scaled, 1));
    sum += channel->steps[s].frequency;
    above_one += channel->steps[s].frequency - 1;
    if (counts[s] > counts[most_frequent]) most_frequent = s;
  }
  // All other symbols pay, in proportion, for the rare ones that were raised to 1. What rounding
  // leaves is taken in steps of 1, and whatever is missing goes to the most frequent symbol.
  if (const int64_t excess = sum - target; excess > 0) {
    for (Step& step : channel->steps) {
      if (step.frequency < 2) continue;
      const int64_t share = excess * (step.frequency - 1) / above_one;
      step.frequency -= static_cast<uint32_t>(share);
      sum -= share;
    }
  }
  for (size_t s = 0; sum > target; s = (s + 1) % counts.size()) {
    if (channel->steps[s].frequency < 2) continue;
    --channel->steps[s].frequency;
    --sum;
  }
  channel->steps[most_frequent].frequency += static_cast<uint32_t>(target - sum);

  uint32_t cumulative = 0;
  for (Step& step : channel->steps) {
    step.cumulative = cumulative;
    cumulative += step.frequency;
    if (step.frequency == 0) continue;
    // With l = ceil(log2 d) and m = floor(2^(31 + l) / d) + 1, the quotient x / d is exact for
    // every x below 2^31. States stay below 1024 * 2^20 = 2^30.
    const int log = std::bit_width(step.frequency - 1);
    step.shift = static_cast<uint32_t>(31 + log);
    step.reciprocal =
        static_cast<uint32_t>((uint64_t{1} << step.shift) / step.frequency + (log > 0 ? 1 : 0));
  }
}

// Codes all three channels. They advance together because every step depends on the one before it
// in the same channel: the processor works on two channels while the third waits for its state.
void ResidualWriter::EncodeSymbols() {
  const size_t count = channels_[0].symbols.size();
  uint32_t state[3], precision[3];
  uint8_t* out[3];
  for (int c = 0; c < 3; ++c) {
    Channel& channel = channels_[c];
    channel.bytes.resize(MostBytes(count));
    out[c] = channel.bytes.data();
    precision[c] = uint32_t{1} << channel.precision_bits;
    state[c] = kLowestState * precision[c];
  }
  for (size_t i = count; i-- > 0;) {
    for (int c = 0; c < 3; ++c) {
      const Step& step = channels_[c].steps[channels_[c].symbols[i]];
      uint32_t x = state[c];
      for (; x >= step.frequency << kStateBits; x >>= 8) *out[c]++ = static_cast<uint8_t>(x);
      const auto quotient = static_cast<uint32_t>((uint64_t{x} * step.reciprocal) >> step.shift);
      state[c] = x + quotient * (precision[c] - step.frequency) + step.cumulative;
    }
  }
  for (int c = 0; c < 3; ++c) {
    // The last state ends the bytes. The two highest bits of the last byte say how many more bytes
    // belong to the state.
    const uint32_t x = state[c] - kLowestState * precision[c];
    const int more = x < 1u << 6 ? 0 : x < 1u << 14 ? 1 : x < 1u << 22 ? 2 : 3;
    const uint32_t word = x + (static_cast<uint32_t>(more) << (6 + 8 * more));
    for (int b = 0; b <= more; ++b) *out[c]++ = static_cast<uint8_t>(word >> (8 * b));
    channels_[c].num_bytes = static_cast<size_t>(out[c] - channels_[c].bytes.data());
  }
}

void ResidualWriter::AppendChannel(const Channel& channel, std::string* bytes) {
  bytes->push_back(static_cast<char>(kNoPrediction));
  bytes->push_back(1);  // entropy coded
  bytes->push_back(kRawSymbols);
  bytes->push_back(static_cast<char>(channel.bit_length));
  AppendVarint(channel.steps.size(), bytes);
  for (size_t s = 0; s < channel.steps.size(); ++s) {
    const uint32_t frequency = channel.steps[s].frequency;
    if (frequency == 0) {  // one entry for up to 64 of them; the last symbol of the table occurs
      size_t more = 0;
      while (more < 63 && channel.steps[s + more + 1].frequency == 0) ++more;
      bytes->push_back(static_cast<char>(more << 2 | 3));
      s += more;
      continue;
    }
    const int extra = frequency < 1u << 6 ? 0 : frequency < 1u << 14 ? 1 : 2;
    bytes->push_back(static_cast<char>(frequency << 2 | static_cast<uint32_t>(extra)));
    for (int b = 1; b <= extra; ++b) bytes->push_back(static_cast<char>(frequency >> (8 * b - 2)));
  }
  AppendVarint(channel.num_bytes, bytes);
  bytes->append(reinterpret_cast<const char*>(channel.bytes.data()), channel.num_bytes);
}

bool ResidualWriter::Write(const Eigen::Matrix3Xi& residuals, std::string* bytes) {
  for (int c = 0; c < 3; ++c) {
    if (!CountSymbols(residuals, c)) return false;
  }
  for (Channel& channel : channels_) Normalize(&channel);
  EncodeSymbols();

  bytes->assign("DRACO\x02\x03", 7);  // version 2.3
  bytes->append(4, '\0');             // point cloud, sequential, two bytes without flags
  AppendLittleEndian(static_cast<uint32_t>(residuals.cols()), 4, bytes);
  bytes->push_back(1);  // one attribute decoder
  bytes->push_back(3);  // its attributes
  for (int c = 0; c < 3; ++c) {
    for (const int field : {int{kGeneric}, int{kInt32}, /*components=*/1, /*normalized=*/0, c}) {
      bytes->push_back(static_cast<char>(field));
    }
  }
  bytes->append(3, static_cast<char>(kIntegerDecoder));
  for (const Channel& channel : channels_) AppendChannel(channel, bytes);
  return true;
}

}  // namespace pleat
