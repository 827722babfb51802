#include "pleat/formats/obj_reader.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\\'; }

// Reads one file from front to back. A line that ends with a backslash goes on in the next one;
// line_ is then the number of its first line. No line is copied: a backslash counts as white space,
// so the cursor walks over the break.
class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& file, const MeshLimits& limits)
      : next_(text.data()), text_end_(text.data() + text.size()), file_(file), limits_(limits) {}

  absl::StatusOr<MeshFile> Parse() {
    while (NextLine()) PLEAT_RETURN_IF_ERROR(ParseLine());
    return Finish();
  }

 private:
  absl::Status Error(const std::string& why, int64_t line) const {
    return absl::InvalidArgumentError(absl::StrCat(file_, ":", line, ": ", why));
  }
  absl::Status Error(const std::string& why) const { return Error(why, line_); }

  bool NextLine() {
    if (next_ == text_end_) return false;
    line_ += 1 + continued_lines_;
    continued_lines_ = 0;
    cursor_ = next_;
    while (true) {
      const auto* newline = static_cast<const char*>(
          std::memchr(next_, '\n', static_cast<size_t>(text_end_ - next_)));
      line_end_ = newline ? newline : text_end_;
      next_ = newline ? newline + 1 : text_end_;
      const char* last = line_end_;
      if (last > cursor_ && last[-1] == '\r') --last;
      if (last == cursor_ || last[-1] != '\\' || next_ == text_end_) return true;
      ++continued_lines_;
    }
  }

  void SkipSpace() {
    while (cursor_ < line_end_ && IsSpace(*cursor_)) ++cursor_;
  }
  bool AtLineEnd() {
    SkipSpace();
    return cursor_ == line_end_ || *cursor_ == '#';
  }
  std::string_view Keyword() {
    SkipSpace();
    const char* begin = cursor_;
    while (cursor_ < line_end_ && !IsSpace(*cursor_)) ++cursor_;
    return {begin, static_cast<size_t>(cursor_ - begin)};
  }
  std::string RestOfLine() {
    SkipSpace();
    const char* end = line_end_;
    while (end > cursor_ && IsSpace(end[-1])) --end;
    return {cursor_, end};
  }
  // Returns the word at the cursor, for messages.
  std::string Found() {
    SkipSpace();
    const char* end = cursor_;
    while (end < line_end_ && !IsSpace(*end) && end - cursor_ < 32) ++end;
    return end == cursor_ ? "the end of the line"
                          : absl::StrCat("'", std::string(cursor_, end), "'");
  }

  bool ParseFloat(float* value) {
    SkipSpace();
    const char* begin = cursor_ < line_end_ && *cursor_ == '+' ? cursor_ + 1 : cursor_;
    std::from_chars_result result = std::from_chars(begin, line_end_, *value);
    if (result.ec == std::errc::result_out_of_range) {
      // A number that is too small for float32 (its exponent is negative) is 0. One that is too
      // large is an error.
      if (result.ptr - begin < 2 || std::find(begin + 1, result.ptr, '-') == result.ptr)
        return false;
      *value = 0;
    } else if (result.ec != std::errc()) {
      return false;
    }
    if (result.ptr < line_end_ && !IsSpace(*result.ptr)) return false;
    cursor_ = result.ptr;
    return true;
  }

  absl::Status ParseLine() {
    const std::string_view keyword = Keyword();
    if (keyword == "v") return ParseVertex();
    if (keyword == "f" || keyword == "fo") return ParseFace();
    if (keyword == "vt") return ParseTexcoord();
    if (keyword == "usemtl") return ParseMaterial();
    if (keyword == "mtllib") mesh_.appearance.material_library = RestOfLine();
    return absl::OkStatus();
  }

  absl::Status ParseVertex() {
    for (int axis = 0; axis < 3; ++axis) {
      float value = 0;
      if (!ParseFloat(&value)) {
        return Error(absl::StrCat("a vertex needs three numbers x y z, found ", Found()));
      }
      coordinates_.push_back(value);
    }
    if (num_vertices() > limits_.max_vertices) {
      return absl::ResourceExhaustedError(absl::StrCat(
          file_, ":", line_, ": more vertices than the limit of ", limits_.max_vertices));
    }
    return absl::OkStatus();
  }

  absl::Status ParseTexcoord() {
    Eigen::Vector2f texcoord = Eigen::Vector2f::Zero();
    if (!ParseFloat(&texcoord.x()) || (!AtLineEnd() && !ParseFloat(&texcoord.y()))) {
      return Error(absl::StrCat("a texture coordinate needs numbers u v, found ", Found()));
    }
    mesh_.appearance.texcoords.push_back(texcoord);
    return absl::OkStatus();
  }

  absl::Status ParseMaterial() {
    const std::string name = RestOfLine();
    std::vector<std::string>& names = mesh_.appearance.material_names;
    const auto [entry, is_new] =
        material_indices_.try_emplace(name, static_cast<int32_t>(names.size()));
    if (is_new) names.push_back(name);
    material_ = entry->second;
    return absl::OkStatus();
  }

  // Reads an index into `count` items so far and makes it count from 0. In the file it counts from
  // 1, or it is negative and counts from the end.
  absl::Status ParseIndex(absl::string_view kind, int64_t count, int32_t* index) {
    int32_t value = 0;
    const std::from_chars_result result = std::from_chars(cursor_, line_end_, value);
    if (result.ec != std::errc()) {
      return Error(absl::StrCat("a face needs ", kind, " numbers, found ", Found()));
    }
    if (value == 0) return Error(absl::StrCat(kind, " numbers start at 1, found 0"));
    if (value < 0 && -static_cast<int64_t>(value) > count) {
      return Error(absl::StrCat(kind, " number ", value, " reaches back beyond the ", count,
                                " defined so far"));
    }
    cursor_ = result.ptr;
    *index = value > 0 ? value - 1 : static_cast<int32_t>(count + value);
    return absl::OkStatus();
  }

  bool Consume(char c) {
    if (cursor_ == line_end_ || *cursor_ != c) return false;
    ++cursor_;
    return true;
  }
  bool AtCornerEnd() const { return cursor_ == line_end_ || IsSpace(*cursor_); }

  absl::Status ParseCorner() {
    int32_t vertex = 0, texcoord = -1, normal = 0;
    PLEAT_RETURN_IF_ERROR(ParseIndex("vertex", num_vertices(), &vertex));
    if (Consume('/')) {
      if (!AtCornerEnd() && *cursor_ != '/') {
        const auto count = static_cast<int64_t>(mesh_.appearance.texcoords.size());
        PLEAT_RETURN_IF_ERROR(ParseIndex("texture coordinate", count, &texcoord));
      }
      // Normals are not kept, so any number will do.
      if (Consume('/') && !AtCornerEnd()) {
        PLEAT_RETURN_IF_ERROR(ParseIndex("normal", std::numeric_limits<int32_t>::max(), &normal));
      }
    }
    if (!AtCornerEnd()) {
      return Error(absl::StrCat("a face corner is a, a/b, a//c or a/b/c; cannot read ", Found()));
    }
    corner_vertices_.push_back(vertex);
    mesh_.appearance.corner_texcoords.push_back(texcoord);
    return absl::OkStatus();
  }

  absl::Status ParseFace() {
    const size_t first = corner_vertices_.size();
    while (!AtLineEnd()) PLEAT_RETURN_IF_ERROR(ParseCorner());
    const size_t num_corners = corner_vertices_.size() - first;
    if (num_corners < 3) {
      return Error(absl::StrCat("a face needs at least 3 corners, found ", num_corners));
    }
    if (static_cast<int64_t>(face_sizes_.size()) >= limits_.max_faces ||
        corner_vertices_.size() > std::numeric_limits<int32_t>::max()) {
      return absl::ResourceExhaustedError(
          absl::StrCat(file_, ":", line_, ": more faces than the limit of ", limits_.max_faces));
    }
    face_sizes_.push_back(static_cast<int32_t>(num_corners));
    face_lines_.push_back(line_);
    mesh_.appearance.face_materials.push_back(material_);
    return absl::OkStatus();
  }

  int64_t num_vertices() const { return static_cast<int64_t>(coordinates_.size() / 3); }

  // A face may name a vertex that a later line defines, so the ranges are known only at the end.
  absl::Status CheckIndices() const {
    const auto num_texcoords = static_cast<int64_t>(mesh_.appearance.texcoords.size());
    size_t corner = 0;
    for (size_t f = 0; f < face_sizes_.size(); ++f) {
      for (int32_t c = 0; c < face_sizes_[f]; ++c, ++corner) {
        if (corner_vertices_[corner] >= num_vertices()) {
          return Error(absl::StrCat("the face names vertex ", corner_vertices_[corner] + int64_t{1},
                                    " but the file has ", num_vertices(), " vertices"),
                       face_lines_[f]);
        }
        const int32_t texcoord = mesh_.appearance.corner_texcoords[corner];
        if (texcoord >= num_texcoords) {
          return Error(absl::StrCat("the face names texture coordinate ", texcoord + int64_t{1},
                                    " but the file has ", num_texcoords),
                       face_lines_[f]);
        }
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<MeshFile> Finish() {
    if (coordinates_.empty() || face_sizes_.empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat(file_, ": no mesh: ", num_vertices(), " vertices (lines 'v x y z') and ",
                       face_sizes_.size(), " faces (lines 'f a b c'); is it an OBJ file?"));
    }
    PLEAT_RETURN_IF_ERROR(CheckIndices());
    mesh_.positions = Eigen::Map<const Eigen::Matrix3Xf>(coordinates_.data(), 3, num_vertices());
    if (mesh_.appearance.texcoords.empty()) mesh_.appearance.corner_texcoords.clear();
    if (mesh_.appearance.material_names.empty()) mesh_.appearance.face_materials.clear();
    PLEAT_ASSIGN_OR_RETURN(mesh_.topology,
                           Topology::Create(static_cast<int>(num_vertices()),
                                            std::move(corner_vertices_), std::move(face_sizes_)));
    return std::move(mesh_);
  }

  const char* next_;  // the first byte of the next line
  const char* text_end_;
  const char* cursor_ = nullptr;  // a place in the current line
  const char* line_end_ = nullptr;
  int32_t line_ = 0;
  int32_t continued_lines_ = 0;
  const std::string& file_;
  const MeshLimits& limits_;

  MeshFile mesh_;
  std::vector<float> coordinates_;
  std::vector<int32_t> corner_vertices_, face_sizes_, face_lines_;
  std::unordered_map<std::string, int32_t> material_indices_;
  int32_t material_ = -1;
};

}  // namespace

absl::StatusOr<MeshFile> DecodeObj(std::string_view text, const std::string& file,
                                   const MeshLimits& limits) {
  if (text.empty()) return absl::InvalidArgumentError(absl::StrCat(file, ": the file is empty"));
  return ObjParser(text, file, limits).Parse();
}

absl::StatusOr<MeshFile> ReadObj(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, limits.max_file_bytes));
  return DecodeObj(text, path, limits);
}

}  // namespace pleat
