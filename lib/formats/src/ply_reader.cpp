#include "pleat/formats/ply_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "ply_header.h"

namespace pleat {
namespace {

// Reads the values of the body one after the other, whatever the encoding. They all become double,
// which holds every scalar type of PLY exactly.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header)
      : begin_(bytes.data()),
        cursor_(bytes.data() + header.body_offset),
        end_(bytes.data() + bytes.size()),
        encoding_(header.encoding),
        first_line_(header.num_lines + 1) {}

  // Returns false when the value is not there or not a number.
  bool Read(PlyScalar type, double* value) {
    return encoding_ == PlyEncoding::kAscii ? ReadText(value) : ReadBinary(type, value);
  }
  size_t remaining() const { return static_cast<size_t>(end_ - cursor_); }
  // Returns the smallest number of bytes that one value takes.
  size_t MinBytes(PlyScalar type) const {
    return encoding_ == PlyEncoding::kAscii ? 1 : static_cast<size_t>(PlyScalarBytes(type));
  }
  // Returns where the cursor stands, for messages.
  std::string Place() const {
    if (encoding_ != PlyEncoding::kAscii) return absl::StrCat("byte ", cursor_ - begin_);
    const auto body_lines = std::count(body_begin_, cursor_, '\n');
    return absl::StrCat("line ", first_line_ + body_lines);
  }

 private:
  bool ReadText(double* value) {
    while (cursor_ < end_ && (*cursor_ == ' ' || (*cursor_ >= '\t' && *cursor_ <= '\r'))) ++cursor_;
    if (cursor_ < end_ && *cursor_ == '+') ++cursor_;
    const std::from_chars_result result = std::from_chars(cursor_, end_, *value);
    if (result.ec != std::errc()) return false;
    cursor_ = result.ptr;
    return true;
  }

  bool ReadBinary(PlyScalar type, double* value) {
    const auto size = static_cast<size_t>(PlyScalarBytes(type));
    if (remaining() < size) return false;
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), cursor_, size);
    if (encoding_ == PlyEncoding::kBigEndian) std::reverse(raw.begin(), raw.begin() + size);
    cursor_ += size;
    switch (type) {
      case PlyScalar::kInt8:
        *value = As<int8_t>(raw);
        break;
      case PlyScalar::kUint8:
        *value = As<uint8_t>(raw);
        break;
      case PlyScalar::kInt16:
        *value = As<int16_t>(raw);
        break;
      case PlyScalar::kUint16:
        *value = As<uint16_t>(raw);
        break;
      case PlyScalar::kInt32:
        *value = As<int32_t>(raw);
        break;
      case PlyScalar::kUint32:
        *value = As<uint32_t>(raw);
        break;
      case PlyScalar::kFloat32:
        *value = As<float>(raw);
        break;
      case PlyScalar::kFloat64:
        *value = As<double>(raw);
        break;
    }
    return true;
  }

  template <typename T>
  static double As(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return static_cast<double>(value);
  }

  const char* begin_;
  const char* cursor_;
  const char* body_begin_ = cursor_;
  const char* end_;
  PlyEncoding encoding_;
  int64_t first_line_;
};

// Reads the elements in the order of the header. The body has no index: an element that is not
// needed must still be read value by value, since its lists may have any length.
class PlyParser {
 public:
  PlyParser(std::string_view bytes, const PlyHeader& header, const std::string& file,
            const MeshLimits& limits)
      : header_(header), body_(bytes, header), file_(file), limits_(limits) {}

  absl::StatusOr<MeshFile> Parse() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      PLEAT_RETURN_IF_ERROR(CheckSize(element));
      if (element.name == "vertex") {
        PLEAT_RETURN_IF_ERROR(ParseVertices(element));
      } else {
        PLEAT_RETURN_IF_ERROR(ParseLists(element));
      }
    }
    return Finish();
  }

 private:
  absl::Status Error(const std::string& why) const {
    return absl::InvalidArgumentError(absl::StrCat(file_, ": ", why));
  }
  absl::Status Unreadable(const PlyElement& element, int64_t item, const std::string& property) {
    return Error(absl::StrCat(body_.Place(), ": cannot read ", element.name, " ", item, ", ",
                              property, ": the file is cut off or the value is no number"));
  }

  // Checks that the body is long enough for the declared count, before anything is allocated for
  // it.
  absl::Status CheckSize(const PlyElement& element) const {
    const bool is_mesh = element.name == "vertex" || element.name == "face";
    const int64_t limit = element.name == "vertex" ? limits_.max_vertices : limits_.max_faces;
    if (is_mesh && element.count > limit) {
      return absl::ResourceExhaustedError(absl::StrCat(
          file_, ": ", element.count, " ", element.name, " elements, the limit is ", limit));
    }
    size_t item_bytes = 0;
    for (const PlyProperty& property : element.properties) {
      item_bytes += body_.MinBytes(property.is_list ? property.size_type : property.type);
    }
    if (static_cast<uint64_t>(element.count) <= body_.remaining() / item_bytes) {
      return absl::OkStatus();
    }
    return Error(absl::StrCat("the header declares ", element.count, " ", element.name,
                              " elements but only ", body_.remaining(),
                              " bytes follow; the file is cut off"));
  }

  // Reads one property of one item. `values` receives its scalars.
  absl::Status ReadProperty(const PlyElement& element, int64_t item, const PlyProperty& property,
                            std::vector<double>* values) {
    double count = 1;
    values->clear();
    if (property.is_list && (!body_.Read(property.size_type, &count) || !(count >= 0) ||
                             count * static_cast<double>(body_.MinBytes(property.type)) >
                                 static_cast<double>(body_.remaining()))) {
      return Unreadable(element, item, absl::StrCat("length of list ", property.name));
    }
    const auto num_values = static_cast<size_t>(count);
    for (size_t i = 0; i < num_values; ++i) {
      double value = 0;
      if (!body_.Read(property.type, &value)) return Unreadable(element, item, property.name);
      values->push_back(value);
    }
    return absl::OkStatus();
  }

  absl::Status ParseVertices(const PlyElement& element) {
    if (mesh_.positions.cols() > 0) return Error("two elements 'vertex'");
    const std::array<int, 3> axes = {element.FindProperty("x"), element.FindProperty("y"),
                                     element.FindProperty("z")};
    for (int axis = 0; axis < 3; ++axis) {
      if (axes[axis] < 0 || element.properties[axes[axis]].is_list) {
        return Error(
            absl::StrCat("element 'vertex' has no scalar property ", std::string(1, "xyz"[axis])));
      }
    }
    const std::array<int, 2> uv = FindTexcoord(element);
    mesh_.positions.resize(3, element.count);
    if (uv[0] >= 0) mesh_.appearance.texcoords.resize(element.count);
    std::vector<double> values;
    for (int64_t v = 0; v < element.count; ++v) {
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        PLEAT_RETURN_IF_ERROR(ReadProperty(element, v, element.properties[p], &values));
        for (int axis = 0; axis < 3; ++axis) {
          if (p == axes[axis]) mesh_.positions(axis, v) = static_cast<float>(values[0]);
        }
        for (int axis = 0; axis < 2; ++axis) {
          if (p != uv[axis]) continue;
          mesh_.appearance.texcoords[v](axis) = static_cast<float>(values[0]);
        }
      }
    }
    return absl::OkStatus();
  }

  // Returns the indices of the properties u and v, or -1 for both.
  static std::array<int, 2> FindTexcoord(const PlyElement& element) {
    constexpr std::array<std::string_view, 2> kNames[] = {
        {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
    for (const auto& [u, v] : kNames) {
      const int iu = element.FindProperty(u), iv = element.FindProperty(v);
      if (iu >= 0 && iv >= 0 && !element.properties[iu].is_list &&
          !element.properties[iv].is_list) {
        return {iu, iv};
      }
    }
    return {-1, -1};
  }

  // Reads the faces, or skips another element, whose values must be read to find its end.
  absl::Status ParseLists(const PlyElement& element) {
    const bool is_face = element.name == "face";
    int corners = element.FindProperty("vertex_indices");
    if (corners < 0) corners = element.FindProperty("vertex_index");
    if (is_face && (corners < 0 || !element.properties[corners].is_list)) {
      return Error("element 'face' has no list vertex_indices or vertex_index");
    }
    if (is_face && !face_sizes_.empty()) return Error("two elements 'face'");
    const int texcoords = is_face ? element.FindProperty("texcoord") : -1;
    std::vector<double> values, corner_values, texcoord_values;
    for (int64_t f = 0; f < element.count; ++f) {
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        std::vector<double>& target = p == corners     ? corner_values
                                      : p == texcoords ? texcoord_values
                                                       : values;
        PLEAT_RETURN_IF_ERROR(ReadProperty(element, f, element.properties[p], &target));
      }
      if (is_face) PLEAT_RETURN_IF_ERROR(AddFace(f, corner_values, texcoord_values));
    }
    return absl::OkStatus();
  }

  absl::Status AddFace(int64_t f, const std::vector<double>& corners,
                       const std::vector<double>& texcoords) {
    if (corners.size() < 3 ||
        corner_vertices_.size() + corners.size() > std::numeric_limits<int32_t>::max()) {
      return Error(absl::StrCat("face ", f, " (", body_.Place(), ") has ", corners.size(),
                                " corners; a face needs at least 3"));
    }
    face_sizes_.push_back(static_cast<int32_t>(corners.size()));
    const bool has_texcoords = texcoords.size() == 2 * corners.size();
    for (size_t c = 0; c < corners.size(); ++c) {
      if (!(corners[c] >= 0) || corners[c] > std::numeric_limits<int32_t>::max() ||
          corners[c] != std::floor(corners[c])) {
        return Error(absl::StrCat("face ", f, " (", body_.Place(), ") names vertex ", corners[c]));
      }
      corner_vertices_.push_back(static_cast<int32_t>(corners[c]));
      corner_texcoords_.push_back(has_texcoords ? static_cast<int32_t>(face_texcoords_.size())
                                                : -1);
      if (!has_texcoords) continue;
      face_texcoords_.emplace_back(static_cast<float>(texcoords[2 * c]),
                                   static_cast<float>(texcoords[2 * c + 1]));
    }
    return absl::OkStatus();
  }

  absl::StatusOr<MeshFile> Finish() {
    if (mesh_.positions.cols() == 0 || face_sizes_.empty()) {
      return Error(absl::StrCat("no mesh: ", mesh_.positions.cols(), " vertices and ",
                                face_sizes_.size(), " faces"));
    }
    if (!face_texcoords_.empty()) {
      mesh_.appearance.texcoords = std::move(face_texcoords_);
      mesh_.appearance.corner_texcoords = std::move(corner_texcoords_);
    } else if (!mesh_.appearance.texcoords.empty()) {
      mesh_.appearance.corner_texcoords = corner_vertices_;
    }
    absl::StatusOr<Topology> topology =
        Topology::Create(static_cast<int>(mesh_.positions.cols()), std::move(corner_vertices_),
                         std::move(face_sizes_));
    if (!topology.ok()) return Error(std::string(topology.status().message()));
    mesh_.topology = *std::move(topology);
    return std::move(mesh_);
  }

  const PlyHeader& header_;
  PlyBody body_;
  const std::string& file_;
  const MeshLimits& limits_;
  MeshFile mesh_;
  std::vector<int32_t> corner_vertices_, face_sizes_, corner_texcoords_;
  std::vector<Eigen::Vector2f> face_texcoords_;
};

}  // namespace

absl::StatusOr<MeshFile> DecodePly(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError(absl::StrCat(file, ": the file is empty"));
  PLEAT_ASSIGN_OR_RETURN(const PlyHeader header, ParsePlyHeader(bytes, file));
  return PlyParser(bytes, header, file, limits).Parse();
}

absl::StatusOr<MeshFile> ReadPly(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  return DecodePly(bytes, path, limits);
}

}  // namespace pleat
