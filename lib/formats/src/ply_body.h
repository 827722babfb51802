// The values behind the header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ply_header.h"

namespace pleat {

// Reads the values of the body one after the other, whatever the encoding. They all become double,
// which holds every scalar type of PLY exactly.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header);

  // Returns false when the value is not there or not a number.
  bool Read(PlyScalar type, double* value) {
    return is_text() ? ReadText(value) : ReadBinary(type, value);
  }
  size_t remaining() const { return static_cast<size_t>(end_ - cursor_); }
  // Returns the smallest number of bytes that one value takes.
  size_t MinBytes(PlyScalar type) const {
    return is_text() ? 1 : static_cast<size_t>(PlyScalarBytes(type));
  }
  // Returns where the cursor stands, for messages.
  std::string Place() const;

  bool is_text() const { return encoding_ == PlyEncoding::kAscii; }
  // Of text: the values from here to the end of the line, blank lines before them skipped; 0 at the
  // end of the file.
  int64_t NumValuesOnLine();
  // Nothing but spaces from here to the end of the line.
  bool AtLineEnd() const;

 private:
  bool ReadText(double* value);
  bool ReadBinary(PlyScalar type, double* value);
  void SkipSpace();

  const char* begin_;
  const char* cursor_;
  const char* body_begin_ = cursor_;
  const char* end_;
  PlyEncoding encoding_;
  int64_t first_line_;
};

}  // namespace pleat
