// The text header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

enum class PlyScalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

int PlyScalarBytes(PlyScalar type);

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::kFloat32;
  bool is_list = false;
  PlyScalar size_type = PlyScalar::kUint8;  // the type of the length of a list
};

struct PlyElement {
  std::string name;
  int64_t count = 0;
  std::vector<PlyProperty> properties;
  int FindProperty(std::string_view property_name) const;  // index or -1
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  size_t body_offset = 0;  // the first byte after the header
  int64_t num_lines = 0;   // the number of lines in the header
};

// Lines end with LF, CR or CR LF, and a byte order mark before them is skipped. kInvalidArgument
// says "file:line" and what is wrong with the header. `file` is the name used in messages.
absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file);

}  // namespace pleat
