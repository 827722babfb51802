#include "npy_array.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "npy_header.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

template <typename T>
T LoadItem(const char* data, bool reverse) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, data, sizeof(T));
  if (reverse) std::reverse(bytes, bytes + sizeof(T));
  return std::bit_cast<T>(bytes);
}

// IEEE 754 half precision.
double FromHalf(uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  double value =
      exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  if (exponent == 31) {
    value = mantissa == 0 ? std::numeric_limits<double>::infinity()
                          : std::numeric_limits<double>::quiet_NaN();
  }
  return (bits & 0x8000) != 0 ? -value : value;
}

double FloatItem(const char* at, size_t size, bool reverse) {
  if (size == 8) return LoadItem<double>(at, reverse);
  if (size == 4) return LoadItem<float>(at, reverse);
  return FromHalf(LoadItem<uint16_t>(at, reverse));
}

template <typename Signed, typename Unsigned>
double IntegerItem(const char* at, bool has_sign, bool reverse) {
  return has_sign ? static_cast<double>(LoadItem<Signed>(at, reverse))
                  : static_cast<double>(LoadItem<Unsigned>(at, reverse));
}

// How far items lie apart whose indices differ by one, in items, for each dimension.
std::vector<int64_t> StridesOf(const NpyArray& array) {
  std::vector<int64_t> strides(array.shape.size());
  int64_t stride = 1;
  for (size_t i = 0; i < strides.size(); ++i) {
    const size_t d = array.is_fortran ? i : strides.size() - 1 - i;
    strides[d] = stride;
    stride *= array.shape[d];
  }
  return strides;
}

// Calls use(place in memory) for all items in the order of C.
template <typename Use>
void ForEachInOrderOfC(const NpyArray& array, Use&& use) {
  const int64_t count = array.num_items();
  if (!array.is_fortran || array.shape.size() < 2) {
    for (int64_t i = 0; i < count; ++i) use(i);
    return;
  }
  const std::vector<int64_t> strides = StridesOf(array);
  std::vector<int64_t> index(array.shape.size());
  for (int64_t i = 0; i < count; ++i) {
    int64_t place = 0;
    for (size_t d = 0; d < index.size(); ++d) place += index[d] * strides[d];
    use(place);
    for (size_t d = index.size(); d-- > 0 && ++index[d] == array.shape[d];) index[d] = 0;
  }
}

// A value of another precision, rounded.
float RoundItem(const char* at, const NpyArray& array, bool* lost) {
  const double value = FloatItem(at, array.item_bytes, array.is_big_endian);
  const auto rounded = static_cast<float>(value);
  *lost = *lost ||
          (array.item_bytes == 8 && static_cast<double>(rounded) != value && std::isfinite(value));
  return rounded;
}

}  // namespace

absl::StatusOr<NpyArray> ParseNpy(std::string_view bytes) {
  size_t num_header_bytes = 0;
  PLEAT_ASSIGN_OR_RETURN(NpyArray array, ParseNpyHeader(bytes, &num_header_bytes));
  const uint64_t there = bytes.size() - num_header_bytes;
  // No count of items can be larger than that of bytes, unless a text has no characters.
  uint64_t num_bytes = std::max<size_t>(array.item_bytes, 1);
  for (const int64_t size : array.shape) {
    if (size != 0 &&
        num_bytes > std::numeric_limits<uint64_t>::max() / static_cast<uint64_t>(size)) {
      return absl::InvalidArgumentError("the shape of the array is larger than any file");
    }
    num_bytes *= static_cast<uint64_t>(size);
  }
  if (num_bytes > there) {
    return absl::DataLossError(absl::StrCat("the array is ", DescribeNpy(array), ", ", num_bytes,
                                            " bytes, but ", there,
                                            " bytes follow its header: it is cut off"));
  }
  if (array.item_bytes == 0) array.item_bytes = 1;
  array.data = bytes.substr(num_header_bytes, num_bytes);
  return array;
}

std::string DescribeNpy(const NpyArray& array) {
  const std::string type = array.kind == 'f'   ? absl::StrCat("float", 8 * array.item_bytes)
                           : array.kind == 'i' ? absl::StrCat("int", 8 * array.item_bytes)
                           : array.kind == 'u' ? absl::StrCat("uint", 8 * array.item_bytes)
                           : array.kind == 'b' ? std::string("bool")
                                               : std::string("text");
  return absl::StrCat(type, " (", absl::StrJoin(array.shape, ", "), ")",
                      array.is_fortran ? " in Fortran order" : "");
}

double NpyNumber(const NpyArray& array, int64_t index) {
  const char* at = array.data.data() + static_cast<size_t>(index) * array.item_bytes;
  const bool reverse = array.is_big_endian, has_sign = array.kind == 'i';
  if (array.is_float()) return FloatItem(at, array.item_bytes, reverse);
  if (array.item_bytes == 1) return IntegerItem<int8_t, uint8_t>(at, has_sign, false);
  if (array.item_bytes == 2) return IntegerItem<int16_t, uint16_t>(at, has_sign, reverse);
  if (array.item_bytes == 4) return IntegerItem<int32_t, uint32_t>(at, has_sign, reverse);
  return IntegerItem<int64_t, uint64_t>(at, has_sign, reverse);
}

absl::StatusOr<std::vector<int32_t>> NpyIntegers(const NpyArray& array) {
  std::vector<int32_t> values(static_cast<size_t>(array.num_items()));
  const bool is_plain = array.kind == 'i' && array.item_bytes == 4 && !array.is_big_endian &&
                        (!array.is_fortran || array.shape.size() < 2);
  if (is_plain) {
    if (!values.empty()) std::memcpy(values.data(), array.data.data(), array.data.size());
    return values;
  }
  size_t i = 0;
  bool is_whole = true;
  ForEachInOrderOfC(array, [&](int64_t place) {
    const double value = NpyNumber(array, place);
    is_whole = is_whole && std::abs(value) <= std::numeric_limits<int32_t>::max() &&
               value == std::floor(value);
    values[i++] = is_whole ? static_cast<int32_t>(value) : 0;
  });
  if (is_whole) return values;
  return absl::InvalidArgumentError("a value is no whole number of 32 bits");
}

std::vector<float> NpyFloats(const NpyArray& array) {
  std::vector<float> values;
  values.reserve(static_cast<size_t>(array.num_items()));
  ForEachInOrderOfC(
      array, [&](int64_t place) { values.push_back(static_cast<float>(NpyNumber(array, place))); });
  return values;
}

bool TakeNpyPositions(const NpyArray& array, std::vector<Eigen::Matrix3Xf>* frames) {
  const bool is_one = array.shape.size() == 2;
  const int64_t num_frames = is_one ? 1 : array.shape[0],
                num_vertices = array.shape[is_one ? 0 : 1];
  const auto num_values = static_cast<size_t>(3 * num_vertices);
  frames->clear();
  frames->reserve(static_cast<size_t>(num_frames));
  for (int64_t t = 0; t < num_frames; ++t) frames->emplace_back(3, num_vertices);
  const char* at = array.data.data();
  bool lost = false;
  if (!array.is_fortran) {
    const bool is_plain = array.item_bytes == 4 && !array.is_big_endian;
    for (Eigen::Matrix3Xf& frame : *frames) {
      if (is_plain) {
        std::memcpy(frame.data(), at, num_values * sizeof(float));
        at += num_values * sizeof(float);
        continue;
      }
      for (size_t i = 0; i < num_values; ++i, at += array.item_bytes) {
        frame.data()[i] = RoundItem(at, array, &lost);
      }
    }
    return lost;
  }
  // Memory is read from its begin to its end; the frames, which it visits in turns, are few.
  for (int k = 0; k < 3; ++k) {
    for (int64_t v = 0; v < num_vertices; ++v) {
      for (Eigen::Matrix3Xf& frame : *frames) {
        frame(k, v) = RoundItem(at, array, &lost);
        at += array.item_bytes;
      }
    }
  }
  return lost;
}

std::string NpyHeader(std::string_view descr, const std::vector<int64_t>& shape) {
  std::string dictionary =
      absl::StrCat("{'descr': '", std::string(descr), "', 'fortran_order': False, 'shape': (",
                   absl::StrJoin(shape, ", "), shape.size() == 1 ? ",), }" : "), }");
  // The items begin at a multiple of 64 bytes.
  const size_t length = (10 + dictionary.size() + 1 + 63) / 64 * 64 - 10;
  dictionary.resize(length - 1, ' ');
  dictionary.push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(length & 0xff));
  header.push_back(static_cast<char>(length >> 8));
  return header + dictionary;
}

std::string EncodeNpyFloats(std::span<const float> values, const std::vector<int64_t>& shape) {
  std::string bytes = NpyHeader("<f4", shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return bytes;
}

std::string EncodeNpyIntegers(std::span<const int32_t> values, const std::vector<int64_t>& shape) {
  std::string bytes = NpyHeader("<i4", shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return bytes;
}

}  // namespace pleat
