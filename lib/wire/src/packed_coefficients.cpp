#include "packed_coefficients.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr size_t kMaxVarintBytes = 5;

void AppendVarint(uint32_t value, std::string* bytes) {
  for (; value >= 0x80; value >>= 7) bytes->push_back(static_cast<char>(value | 0x80));
  bytes->push_back(static_cast<char>(value));
}

absl::Status Damaged(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("packed coefficients: ", what));
}

// Reads one varint at *place and moves on; false where the bytes end or it is too long.
bool ReadVarint(const std::vector<uint8_t>& bytes, size_t* place, uint32_t* value) {
  *value = 0;
  for (int shift = 0; shift < 35 && *place < bytes.size(); shift += 7) {
    const uint8_t byte = bytes[(*place)++];
    *value |= static_cast<uint32_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return true;
  }
  return false;
}

}  // namespace

std::string PackCoefficients(const Eigen::VectorXf& coefficients) {
  constexpr double kLargest = 1 << 30;
  std::string varints;
  for (const float coefficient : coefficients) {
    const double steps =
        std::round(static_cast<double>(coefficient) / static_cast<double>(kCoefficientStep_m));
    const auto whole = static_cast<int32_t>(std::clamp(steps, -kLargest, kLargest));
    AppendVarint((static_cast<uint32_t>(whole) << 1) ^ static_cast<uint32_t>(whole >> 31),
                 &varints);
  }
  uLongf size = compressBound(varints.size());
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(varints.data()), varints.size(), Z_BEST_SPEED);
  packed.resize(size);
  return packed;
}

absl::StatusOr<Eigen::VectorXf> UnpackCoefficients(std::string_view bytes, int max_count) {
  std::vector<uint8_t> varints(kMaxVarintBytes * static_cast<size_t>(max_count));
  uLongf size = varints.size();
  if (uncompress(varints.data(), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 bytes.size()) != Z_OK) {
    return Damaged(absl::StrCat("they cannot be inflated, or hold more than ", max_count));
  }
  varints.resize(size);
  std::vector<float> coefficients;
  for (size_t place = 0; place < varints.size();) {
    uint32_t zigzag = 0;
    if (static_cast<int>(coefficients.size()) == max_count) {
      return Damaged(absl::StrCat("there are more than ", max_count));
    }
    if (!ReadVarint(varints, &place, &zigzag)) return Damaged("the last one is cut off");
    const int32_t steps = static_cast<int32_t>(zigzag >> 1) ^ -static_cast<int32_t>(zigzag & 1);
    coefficients.push_back(static_cast<float>(steps) * kCoefficientStep_m);
  }
  return Eigen::VectorXf(Eigen::Map<const Eigen::VectorXf>(
      coefficients.data(), static_cast<Eigen::Index>(coefficients.size())));
}

}  // namespace pleat
