// A little-endian byte writer and a bounds-checked reader: the base of every binary format.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace pleat {

// The writer and the reader copy values as they lie in memory, so the machine has to be
// little-endian itself.
static_assert(std::endian::native == std::endian::little, "formats are written little-endian");

template <typename T>
concept Scalar = std::integral<T> || std::floating_point<T>;

// Appends scalars, arrays and length-prefixed strings to a growing buffer. It writes no padding and
// no type marks: a format is what its code writes, in that order.
class ByteWriter {
 public:
  template <Scalar T>
  void Write(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <Scalar T>
  void WriteArray(std::span<const T> values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  // Writes the length as uint32, then the bytes; `text` must be shorter than 4 GiB.
  void WriteString(std::string_view text) {
    Write(static_cast<uint32_t>(text.size()));
    bytes_.append(text);
  }
  void WriteRaw(std::string_view raw) { bytes_.append(raw); }

  size_t size() const { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }
  std::string Release() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Reads what ByteWriter wrote, from bytes that may be hostile: each call checks that the bytes are
// there before it allocates or copies. Errors are kDataLoss and name `what` and the offset. The
// bytes must outlive the reader and every view that ReadRaw() returns.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  size_t remaining() const { return bytes_.size() - offset_; }
  size_t offset() const { return offset_; }

  template <Scalar T>
  absl::StatusOr<T> Read(absl::string_view what) {
    if (absl::Status status = Require(1, sizeof(T), what); !status.ok()) return status;
    T value;
    std::memcpy(&value, bytes_.data() + offset_, sizeof(T));
    offset_ += sizeof(T);
    return value;
  }
  // Fills `values` completely or fails and leaves the offset where it was.
  template <Scalar T>
  absl::Status ReadArray(std::span<T> values, absl::string_view what) {
    if (absl::Status status = Require(values.size(), sizeof(T), what); !status.ok()) return status;
    if (!values.empty()) std::memcpy(values.data(), bytes_.data() + offset_, values.size_bytes());
    offset_ += values.size_bytes();
    return absl::OkStatus();
  }
  // Reads a string of ByteWriter::WriteString. A declared length above `max_bytes` is an error
  // before anything is allocated.
  absl::StatusOr<std::string> ReadString(size_t max_bytes, absl::string_view what);
  // Returns `count` raw bytes as a view into the input.
  absl::StatusOr<std::string_view> ReadRaw(size_t count, absl::string_view what);
  // Returns OK when `count` items of `item_bytes` each are still there. Call it before allocating
  // for a count that the file declares.
  absl::Status Require(uint64_t count, uint64_t item_bytes, absl::string_view what) const;

 private:
  std::string_view bytes_;
  size_t offset_ = 0;
};

}  // namespace pleat
