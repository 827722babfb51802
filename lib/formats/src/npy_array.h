// NumPy's array files (.npy), the members of .npz.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// An array in bytes that must outlive it. All its elements are there.
struct NpyArray {
  char kind = 'f';        // of NumPy: f float, i integer, u without sign, b bool, U and S text
  size_t item_bytes = 4;  // for U and S of a whole text
  bool is_big_endian = false;
  bool is_fortran = false;       // the first index runs fastest
  std::vector<int64_t> shape{};  // none of them negative; empty for a single number
  std::string_view data{};       // num_items() * item_bytes

  bool is_float() const { return kind == 'f'; }
  bool is_integer() const { return kind == 'i' || kind == 'u'; }
  int64_t num_items() const { return static_cast<int64_t>(data.size() / item_bytes); }
};

// kInvalidArgument says why it is no array that can be read (objects, records, complex numbers),
// kDataLoss that it is cut off.
absl::StatusOr<NpyArray> ParseNpy(std::string_view bytes);

// "float32 (175, 10002, 3)", for messages.
std::string DescribeNpy(const NpyArray& array);

// Item `index` as a number, counted as they lie in memory. Not for text.
double NpyNumber(const NpyArray& array, int64_t index);
// All items in the order of C (the last index runs fastest), whatever their order in memory.
// kInvalidArgument when one is no whole number of 32 bits. For integer and float arrays.
absl::StatusOr<std::vector<int32_t>> NpyIntegers(const NpyArray& array);
std::vector<float> NpyFloats(const NpyArray& array);
// The texts of an array of kind U or S as UTF-8.
std::vector<std::string> NpyTexts(const NpyArray& array);

// Takes the positions of all frames from a float array of shape (T, V, 3), or (V, 3) for one frame.
// Its shape must be that; the values may be anything. Returns whether any lost digits.
bool TakeNpyPositions(const NpyArray& array, std::vector<Eigen::Matrix3Xf>* frames);

// The header of an array in the order of C that `descr` and `shape` describe: what stands before
// the items.
std::string NpyHeader(std::string_view descr, const std::vector<int64_t>& shape);
std::string EncodeNpyFloats(std::span<const float> values, const std::vector<int64_t>& shape);
std::string EncodeNpyIntegers(std::span<const int32_t> values, const std::vector<int64_t>& shape);
// Of kind U; texts are UTF-8.
std::string EncodeNpyTexts(const std::vector<std::string>& texts);

}  // namespace pleat
