#include "pleat/formats/ply_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "ply_body.h"
#include "ply_header.h"

namespace pleat {
namespace {

constexpr std::string_view kFaceLists[] = {"vertex_indices", "vertex_index"};

// Strips run through their vertices; each vertex from the third on closes a triangle with the two
// before it, every second one turned around. -1 begins a new strip.
constexpr double kStripEnd = -1;

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
      } else if (element.name == "tristrips") {
        PLEAT_RETURN_IF_ERROR(ParseStrips(element));
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

  // Of text: an element without lists is one line, so a line with other values than declared is
  // named before they are taken for those of the next.
  absl::Status CheckLine(const PlyElement& element) {
    if (!body_.is_text()) return absl::OkStatus();
    const int64_t found = body_.NumValuesOnLine();
    const auto declared = static_cast<int64_t>(element.properties.size());
    if (found == declared || found == 0) return absl::OkStatus();
    return Error(absl::StrCat(body_.Place(), ": ", found, found == 1 ? " value" : " values",
                              " where the header declares ", declared, " for element '",
                              EscapeControls(element.name), "'"));
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
    NoteDropped(element, axes, uv);
    std::vector<double> values;
    const bool has_list = std::ranges::any_of(element.properties, &PlyProperty::is_list);
    for (int64_t v = 0; v < element.count; ++v) {
      if (!has_list) PLEAT_RETURN_IF_ERROR(CheckLine(element));
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

  // Names the properties of the vertices that are not taken.
  void NoteDropped(const PlyElement& element, const std::array<int, 3>& axes,
                   const std::array<int, 2>& uv) {
    for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
      if (std::ranges::count(axes, p) + std::ranges::count(uv, p) > 0) continue;
      dropped_.push_back(EscapeControls(element.properties[static_cast<size_t>(p)].name));
    }
  }

  static int FindFaceList(const PlyElement& element) {
    for (const std::string_view name : kFaceLists) {
      const int list = element.FindProperty(name);
      if (list >= 0) return list;
    }
    return -1;
  }

  absl::Status ParseStrips(const PlyElement& element) {
    const int list = FindFaceList(element);
    if (list < 0 || !element.properties[list].is_list) {
      return Error("element 'tristrips' has no list vertex_indices or vertex_index");
    }
    if (!face_sizes_.empty()) return Error("faces and triangle strips in one file");
    std::vector<double> values, strip;
    for (int64_t item = 0; item < element.count; ++item) {
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        PLEAT_RETURN_IF_ERROR(
            ReadProperty(element, item, element.properties[p], p == list ? &strip : &values));
      }
      PLEAT_RETURN_IF_ERROR(AddStrip(item, strip));
    }
    Note("strips_read", absl::StrCat("triangle strips read as ", face_sizes_.size(), " triangles"));
    return absl::OkStatus();
  }

  // Strips repeat vertices to turn corners; the triangles without area that this makes are none.
  absl::Status AddStrip(int64_t item, const std::vector<double>& strip) {
    size_t begin = 0;
    for (size_t i = 0; i < strip.size(); ++i) {
      if (strip[i] == kStripEnd) begin = i + 1;
      if (strip[i] == kStripEnd || i < begin + 2) continue;
      const bool turned = (i - begin) % 2 == 1;
      const std::vector<double> corners = {strip[turned ? i - 1 : i - 2],
                                           strip[turned ? i - 2 : i - 1], strip[i]};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2])
        continue;
      if (static_cast<int64_t>(face_sizes_.size()) >= limits_.max_faces) {
        return absl::ResourceExhaustedError(absl::StrCat(
            file_, ": more triangles in strips than the limit of ", limits_.max_faces));
      }
      PLEAT_RETURN_IF_ERROR(AddFace(item, corners, {}));
    }
    return absl::OkStatus();
  }

  // Reads the faces, or skips another element, whose values must be read to find its end.
  absl::Status ParseLists(const PlyElement& element) {
    const bool is_face = element.name == "face";
    const int corners = FindFaceList(element);
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
      if (body_.is_text() && !body_.AtLineEnd()) {
        return Error(absl::StrCat(body_.Place(), ": more values than the header declares for ",
                                  EscapeControls(element.name), " ", f));
      }
      if (is_face) PLEAT_RETURN_IF_ERROR(AddFace(f, corner_values, texcoord_values));
    }
    if (!is_face && element.count > 0) {
      dropped_.push_back(absl::StrCat("element '", EscapeControls(element.name), "'"));
    }
    return absl::OkStatus();
  }

  absl::Status AddFace(int64_t f, const std::vector<double>& corners,
                       const std::vector<double>& texcoords) {
    if (corners.size() < 3) {
      small_face_corners_ = num_small_faces_++ == 0 || small_face_corners_ == corners.size()
                                ? corners.size()
                                : kMixedCorners;
      return absl::OkStatus();
    }
    if (corner_vertices_.size() + corners.size() > std::numeric_limits<int32_t>::max()) {
      return Error("more corners than an index can hold");
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

  void Note(const char* kind, std::string text) {
    mesh_.notes.push_back({.kind = kind, .text = std::move(text)});
  }

  void NoteLeftOut() {
    if (num_small_faces_ > 0) {
      const std::string corners =
          small_face_corners_ == kMixedCorners
              ? "fewer than 3 corners"
              : absl::StrCat(small_face_corners_,
                             small_face_corners_ == 1 ? " corner" : " corners");
      Note("faces_left_out",
           absl::StrCat(num_small_faces_, num_small_faces_ == 1 ? " face" : " faces", " with ",
                        corners, " left out"));
    }
    if (!dropped_.empty()) {
      Note("not_kept", absl::StrCat("not kept: ", absl::StrJoin(dropped_, ", ")));
    }
  }

  absl::StatusOr<MeshFile> Finish() {
    if (mesh_.positions.cols() == 0 || face_sizes_.empty()) {
      const bool is_empty = mesh_.positions.cols() == 0 && face_sizes_.empty();
      return Error(absl::StrCat(
          is_empty ? "the mesh is empty: " : "no mesh: ", mesh_.positions.cols(), " vertices and ",
          face_sizes_.size(), " faces", mesh_.positions.cols() > 0 ? ", a point cloud" : ""));
    }
    NoteLeftOut();
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

  static constexpr size_t kMixedCorners = 3;
  int64_t num_small_faces_ = 0;
  size_t small_face_corners_ = 0;     // of each, kMixedCorners = different numbers
  std::vector<std::string> dropped_;  // names of properties and elements
};

}  // namespace

absl::StatusOr<MeshFile> DecodePly(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError(absl::StrCat(file, ": the file is empty"));
  PLEAT_RETURN_IF_ERROR(RefuseForeignBytes(bytes, file));
  PLEAT_ASSIGN_OR_RETURN(const PlyHeader header, ParsePlyHeader(bytes, file));
  return PlyParser(bytes, header, file, limits).Parse();
}

absl::StatusOr<MeshFile> ReadPly(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  return DecodePly(bytes, path, limits);
}

}  // namespace pleat
