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
  PlyScalar size_type = PlyScalar::kUint8;  // of a list's length
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
  size_t body_offset = 0;  // first byte after the header
  int64_t num_lines = 0;   // of the header
};

// kInvalidArgument with "file:line" when the header is not one.
absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file);

}  // namespace pleat
