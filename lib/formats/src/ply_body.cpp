#include "ply_body.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

bool IsLineEnd(char c) { return c == '\n' || c == '\r'; }
bool IsSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

template <typename T>
double As(const std::array<char, 8>& raw) {
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return static_cast<double>(value);
}

double FromBytes(PlyScalar type, const std::array<char, 8>& raw) {
  switch (type) {
    case PlyScalar::kInt8:
      return As<int8_t>(raw);
    case PlyScalar::kUint8:
      return As<uint8_t>(raw);
    case PlyScalar::kInt16:
      return As<int16_t>(raw);
    case PlyScalar::kUint16:
      return As<uint16_t>(raw);
    case PlyScalar::kInt32:
      return As<int32_t>(raw);
    case PlyScalar::kUint32:
      return As<uint32_t>(raw);
    case PlyScalar::kFloat32:
      return As<float>(raw);
    case PlyScalar::kFloat64:
      return As<double>(raw);
  }
  return 0;
}

}  // namespace

PlyBody::PlyBody(std::string_view bytes, const PlyHeader& header)
    : begin_(bytes.data()),
      cursor_(bytes.data() + header.body_offset),
      end_(bytes.data() + bytes.size()),
      encoding_(header.encoding),
      first_line_(header.num_lines + 1) {}

std::string PlyBody::Place() const {
  if (!is_text()) return absl::StrCat("byte ", cursor_ - begin_);
  int64_t num_lines = 0;
  for (const char* c = body_begin_; c < cursor_; ++c) {
    num_lines += *c == '\n' || (*c == '\r' && (c + 1 == end_ || c[1] != '\n'));
  }
  return absl::StrCat("line ", first_line_ + num_lines);
}

void PlyBody::SkipSpace() {
  while (cursor_ < end_ && IsSpace(*cursor_)) ++cursor_;
}

int64_t PlyBody::NumValuesOnLine() {
  SkipSpace();
  int64_t num_values = 0;
  for (const char* c = cursor_; c < end_ && !IsLineEnd(*c); ++c) {
    num_values += !IsSpace(*c) && (c == cursor_ || IsSpace(c[-1]));
  }
  return num_values;
}

bool PlyBody::AtLineEnd() const {
  const char* c = cursor_;
  while (c < end_ && IsSpace(*c) && !IsLineEnd(*c)) ++c;
  return c == end_ || IsLineEnd(*c);
}

bool PlyBody::ReadText(double* value) {
  SkipSpace();
  if (cursor_ < end_ && *cursor_ == '+') ++cursor_;
  const std::from_chars_result result = std::from_chars(cursor_, end_, *value);
  if (result.ec != std::errc()) return false;
  cursor_ = result.ptr;
  return true;
}

bool PlyBody::ReadBinary(PlyScalar type, double* value) {
  const auto size = static_cast<size_t>(PlyScalarBytes(type));
  if (remaining() < size) return false;
  std::array<char, 8> raw{};
  std::memcpy(raw.data(), cursor_, size);
  if (encoding_ == PlyEncoding::kBigEndian) std::reverse(raw.begin(), raw.begin() + size);
  cursor_ += size;
  *value = FromBytes(type, raw);
  return true;
}

}  // namespace pleat
