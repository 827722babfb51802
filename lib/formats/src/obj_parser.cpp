#include "obj_parser.h"

#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "obj_lines.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

// An integer that a corner may hold where no item of its kind exists.
constexpr int32_t kNoIndex = -1;

bool IsFreeForm(std::string_view keyword) {
  return keyword == "curv" || keyword == "curv2" || keyword == "surf" || keyword == "cstype";
}

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& file, const MeshLimits& limits,
            const ObjFaceText* known)
      : lines_(text), file_(file), limits_(limits), known_(known) {
    if (known) coordinates_.reserve(3 * static_cast<size_t>(known->num_vertices));
  }

  absl::StatusOr<ObjFrame> Parse(ObjFaceText* faces) {
    while (!has_known_faces_ && lines_.Next()) PLEAT_RETURN_IF_ERROR(ParseLine());
    const std::string_view face_text = face_text_;
    const int64_t vertices_before = vertices_before_faces_, all_vertices = num_vertices();
    const int64_t texcoords_before = texcoords_before_faces_;
    PLEAT_ASSIGN_OR_RETURN(ObjFrame frame, Finish());
    if (faces != nullptr && vertices_before == all_vertices) {
      *faces = {std::string(face_text), vertices_before, texcoords_before, notes_};
    }
    return frame;
  }

 private:
  absl::Status Error(const std::string& why, int64_t line) const {
    return absl::InvalidArgumentError(absl::StrCat(file_, ":", line, ": ", why));
  }
  absl::Status Error(const std::string& why) const { return Error(why, lines_.line()); }

  absl::Status ParseLine() {
    const std::string_view keyword = lines_.Word();
    if (keyword == "v") return ParseVertex();
    if (keyword == "f" || keyword == "fo") return ParseFace();
    if (keyword.empty() || keyword[0] == '#') return absl::OkStatus();
    if (keyword == "vt") {
      ParseTexcoord();
    } else if (keyword == "usemtl") {
      ParseMaterial();
    } else if (keyword == "mtllib") {
      mesh_.appearance.material_library = ReadName();
    } else {
      CountDropped(keyword);
    }
    return absl::OkStatus();
  }

  void CountDropped(std::string_view keyword) {
    if (keyword == "vn") {
      notes_.has_normals = true;
    } else if (keyword == "g" || keyword == "o") {
      ++notes_.num_groups;
    } else if (keyword == "s") {
      const std::string_view value = lines_.Word();
      notes_.has_smoothing |= value != "off" && value != "0";
    } else if (keyword == "l" || keyword == "p") {
      ++notes_.num_lines_and_points;
    } else if (IsFreeForm(keyword)) {
      notes_.free_forms.Add(lines_.line());
    }
  }

  absl::Status ParseVertex() {
    lines_.ContinueLine();
    for (int axis = 0; axis < 3; ++axis) {
      float value = 0;
      if (!lines_.ReadFloat(&value)) {
        return Error(absl::StrCat("a vertex needs three numbers x y z, found ", lines_.Found()));
      }
      coordinates_.push_back(value);
    }
    if (num_vertices() > limits_.max_vertices) {
      return absl::ResourceExhaustedError(absl::StrCat(
          file_, ":", lines_.line(), ": more vertices than the limit of ", limits_.max_vertices));
    }
    return lines_.AtLineEnd() ? absl::OkStatus() : ParseMoreOfVertex();
  }

  // A fourth number is the weight of a rational curve, three or more are a color. Anything but a
  // number is a fault: most likely two lines that have become one.
  absl::Status ParseMoreOfVertex() {
    int num_values = 0;
    while (!lines_.AtLineEnd()) {
      float value = 0;
      if (!lines_.ReadFloat(&value)) {
        return Error(absl::StrCat("a vertex has three numbers x y z, found ", lines_.Found(),
                                  " after them"));
      }
      ++num_values;
    }
    (num_values < 3 ? notes_.has_weights : notes_.has_colors) = true;
    return absl::OkStatus();
  }

  // Only the first frame's texture coordinates are kept; of the others their number matters.
  void ParseTexcoord() {
    ++num_texcoords_;
    lines_.ContinueLine();  // even if nothing is read: a joined line is no statement of its own
    if (known_ != nullptr) return;
    Eigen::Vector2f texcoord = Eigen::Vector2f::Zero();
    if (!lines_.ReadFloat(&texcoord.x()) ||
        (!lines_.AtLineEnd() && !lines_.ReadFloat(&texcoord.y()))) {
      notes_.unreadable_texcoords.Add(lines_.line());
      texcoord.setZero();
    }
    mesh_.appearance.texcoords.push_back(texcoord);
  }

  std::string ReadName() {
    const std::string_view name = lines_.RestOfLine();
    if (!IsValidUtf8(name)) notes_.foreign_names.Add(lines_.line());
    return NameToUtf8(name);
  }

  void ParseMaterial() {
    std::string name = ReadName();
    std::vector<std::string>& names = mesh_.appearance.material_names;
    const auto [entry, is_new] =
        material_indices_.try_emplace(name, static_cast<int32_t>(names.size()));
    if (is_new) names.push_back(std::move(name));
    material_ = entry->second;
  }

  // An index into the vertices seen so far: 1-based, or negative = counted from the end.
  absl::Status ParseVertexIndex(int32_t* index) {
    int32_t value = 0;
    if (!lines_.ReadInteger(&value)) {
      return Error(absl::StrCat("a face needs vertex numbers, found ", lines_.Found()));
    }
    if (value == 0) return Error("vertex numbers start at 1, found 0");
    if (value < 0 && -static_cast<int64_t>(value) > num_vertices()) {
      return Error(absl::StrCat("vertex number ", value, " reaches back beyond the ",
                                num_vertices(), " defined so far"));
    }
    *index = value > 0 ? value - 1 : static_cast<int32_t>(num_vertices() + value);
    return absl::OkStatus();
  }

  // The same for a texture coordinate. What is not there is looked for at the end of the file:
  // max() stands for it until then.
  absl::Status ParseTexcoordIndex(int32_t* index) {
    int32_t value = 0;
    if (!lines_.ReadInteger(&value)) {
      return Error(absl::StrCat("a face needs texture coordinate numbers, found ", lines_.Found()));
    }
    const int64_t from_end = num_texcoords_ + value;
    *index = value > 0                    ? value - 1
             : value < 0 && from_end >= 0 ? static_cast<int32_t>(from_end)
                                          : std::numeric_limits<int32_t>::max();
    return absl::OkStatus();
  }

  absl::Status ParseCorner() {
    int32_t vertex = 0, texcoord = kNoIndex;
    PLEAT_RETURN_IF_ERROR(ParseVertexIndex(&vertex));
    if (lines_.Consume('/')) {
      if (!lines_.AtSpaceOrEnd() && !lines_.At('/')) {
        PLEAT_RETURN_IF_ERROR(ParseTexcoordIndex(&texcoord));
      }
      // Normals are recomputed, never kept: any number will do, whether it is there or not.
      if (lines_.Consume('/')) lines_.SkipInteger();
    }
    if (!lines_.AtSpaceOrEnd()) {
      return Error(
          absl::StrCat("a face corner is a, a/b, a//c or a/b/c; cannot read ", lines_.Found()));
    }
    corner_vertices_.push_back(vertex);
    mesh_.appearance.corner_texcoords.push_back(texcoord);
    return absl::OkStatus();
  }

  absl::Status ParseFace() {
    if (face_text_.empty()) {
      face_text_ = lines_.TextFromLine();
      notes_before_faces_ = std::exchange(notes_, ObjNotes());
      vertices_before_faces_ = num_vertices();
      texcoords_before_faces_ = num_texcoords_;
      has_known_faces_ = known_ != nullptr && known_->num_vertices == num_vertices() &&
                         known_->num_texcoords == num_texcoords_ && known_->text == face_text_;
      if (has_known_faces_) return absl::OkStatus();
    }
    lines_.ContinueLine();
    const size_t first = corner_vertices_.size();
    while (!lines_.AtLineEnd()) PLEAT_RETURN_IF_ERROR(ParseCorner());
    const size_t num_corners = corner_vertices_.size() - first;
    if (num_corners < 3) {
      notes_.AddSmallFace(static_cast<int32_t>(num_corners), lines_.line());
      corner_vertices_.resize(first);
      mesh_.appearance.corner_texcoords.resize(first);
      return absl::OkStatus();
    }
    if (static_cast<int64_t>(face_sizes_.size()) >= limits_.max_faces ||
        corner_vertices_.size() > std::numeric_limits<int32_t>::max()) {
      return absl::ResourceExhaustedError(absl::StrCat(
          file_, ":", lines_.line(), ": more faces than the limit of ", limits_.max_faces));
    }
    face_sizes_.push_back(static_cast<int32_t>(num_corners));
    face_lines_.push_back(lines_.line());
    mesh_.appearance.face_materials.push_back(material_);
    return absl::OkStatus();
  }

  int64_t num_vertices() const { return static_cast<int64_t>(coordinates_.size() / 3); }

  // A face may name a vertex that a later line defines, so ranges are known only at the end.
  absl::Status CheckIndices() {
    size_t corner = 0;
    for (size_t f = 0; f < face_sizes_.size(); ++f) {
      for (int32_t c = 0; c < face_sizes_[f]; ++c, ++corner) {
        if (corner_vertices_[corner] >= num_vertices()) {
          return Error(absl::StrCat("the face names vertex ", corner_vertices_[corner] + int64_t{1},
                                    " but the file has ", num_vertices(), " vertices"),
                       face_lines_[f]);
        }
        int32_t& texcoord = mesh_.appearance.corner_texcoords[corner];
        if (texcoord < num_texcoords_) continue;
        texcoord = kNoIndex;
        notes_.missing_texcoords.Add(face_lines_[f]);
      }
    }
    return absl::OkStatus();
  }

  absl::Status NoMesh() const {
    const bool is_empty = coordinates_.empty() && face_sizes_.empty();
    return absl::InvalidArgumentError(
        absl::StrCat(file_, is_empty ? ": the mesh is empty: " : ": no mesh: ", num_vertices(),
                     " vertices (lines 'v x y z') and ", face_sizes_.size(),
                     " faces (lines 'f a b c') of 3 corners or more; is it an OBJ file?",
                     is_empty ? " If it is, remove it" : ""));
  }

  absl::StatusOr<ObjFrame> Finish() {
    ObjFrame frame;
    frame.has_known_faces = has_known_faces_;
    if (has_known_faces_) {
      notes_ = known_->notes;
    } else {
      if (coordinates_.empty() || face_sizes_.empty()) return NoMesh();
      PLEAT_RETURN_IF_ERROR(CheckIndices());
      PLEAT_ASSIGN_OR_RETURN(mesh_.topology,
                             Topology::Create(static_cast<int>(num_vertices()),
                                              std::move(corner_vertices_), std::move(face_sizes_)));
    }
    mesh_.positions = Eigen::Map<const Eigen::Matrix3Xf>(coordinates_.data(), 3, num_vertices());
    if (mesh_.appearance.texcoords.empty()) mesh_.appearance.corner_texcoords.clear();
    if (mesh_.appearance.material_names.empty()) mesh_.appearance.face_materials.clear();
    notes_before_faces_.Add(notes_);
    mesh_.notes = notes_before_faces_.ToInputNotes();
    frame.mesh = std::move(mesh_);
    return frame;
  }

  ObjLines lines_;
  const std::string& file_;
  const MeshLimits& limits_;
  const ObjFaceText* const known_;

  MeshFile mesh_;
  ObjNotes notes_before_faces_;  // until the first face
  ObjNotes notes_;               // since then
  std::vector<float> coordinates_;
  int64_t num_texcoords_ = 0;
  std::vector<int32_t> corner_vertices_, face_sizes_, face_lines_;
  std::unordered_map<std::string, int32_t> material_indices_;
  int32_t material_ = -1;

  std::string_view face_text_;  // from the first face on; empty before it
  int64_t vertices_before_faces_ = 0, texcoords_before_faces_ = 0;
  bool has_known_faces_ = false;
};

}  // namespace

absl::StatusOr<ObjFrame> ParseObj(std::string_view text, const std::string& file,
                                  const MeshLimits& limits, const ObjFaceText* known,
                                  ObjFaceText* faces) {
  if (text.empty()) return absl::InvalidArgumentError(absl::StrCat(file, ": the file is empty"));
  PLEAT_RETURN_IF_ERROR(RefuseForeignBytes(text, file));
  return ObjParser(text, file, limits, known).Parse(faces);
}

}  // namespace pleat
