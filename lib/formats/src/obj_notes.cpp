#include "obj_notes.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace pleat {
namespace {

std::string Count(int64_t count, const char* singular, const char* plural) {
  return absl::StrCat(count, " ", count == 1 ? singular : plural);
}

std::string Place(const LineCount& lines) {
  return absl::StrCat(lines.count == 1 ? " (line " : " (the first in line ", lines.first_line, ")");
}

// What every exporter writes and a character does not need.
std::string DescribeDropped(const ObjNotes& notes) {
  std::vector<std::string> dropped;
  if (notes.has_colors) dropped.emplace_back("vertex colors");
  if (notes.has_weights) dropped.emplace_back("a fourth coordinate of vertices");
  if (notes.has_normals) dropped.emplace_back("normals (computed where they are needed)");
  if (notes.num_groups > 0) {
    dropped.push_back(Count(notes.num_groups, "group or object", "groups and objects"));
  }
  if (notes.has_smoothing) dropped.emplace_back("smoothing groups");
  if (notes.num_lines_and_points > 0) {
    dropped.push_back(Count(notes.num_lines_and_points, "line or point", "lines and points"));
  }
  return dropped.empty() ? "" : absl::StrCat("not kept: ", absl::StrJoin(dropped, ", "));
}

}  // namespace

void ObjNotes::AddSmallFace(int32_t num_corners, int32_t line) {
  if (small_faces.count == 0) small_face_corners = num_corners;
  if (small_face_corners != num_corners) small_face_corners = -1;
  small_faces.Add(line);
}

void ObjNotes::Add(const ObjNotes& later) {
  if (small_faces.count == 0) small_face_corners = later.small_face_corners;
  if (later.small_faces.count > 0 && later.small_face_corners != small_face_corners) {
    small_face_corners = -1;
  }
  small_faces.Add(later.small_faces);
  missing_texcoords.Add(later.missing_texcoords);
  unreadable_texcoords.Add(later.unreadable_texcoords);
  foreign_names.Add(later.foreign_names);
  free_forms.Add(later.free_forms);
  num_groups += later.num_groups;
  num_lines_and_points += later.num_lines_and_points;
  has_colors |= later.has_colors;
  has_weights |= later.has_weights;
  has_normals |= later.has_normals;
  has_smoothing |= later.has_smoothing;
}

std::vector<InputNote> ObjNotes::ToInputNotes() const {
  std::vector<InputNote> notes;
  const auto add = [&](NoteSeverity severity, const char* kind, std::string text) {
    notes.push_back({.severity = severity, .kind = kind, .text = std::move(text)});
  };
  if (small_faces.count > 0) {
    const std::string corners = small_face_corners < 0
                                    ? "fewer than 3 corners"
                                    : Count(small_face_corners, "corner", "corners");
    add(NoteSeverity::kNote, "faces_left_out",
        absl::StrCat(Count(small_faces.count, "face", "faces"), " with ", corners, " left out",
                     Place(small_faces)));
  }
  if (missing_texcoords.count > 0) {
    add(NoteSeverity::kNote, "texcoords_missing",
        absl::StrCat("texture coordinates missing for ",
                     Count(missing_texcoords.count, "corner", "corners"), ", ignored",
                     Place(missing_texcoords)));
  }
  if (unreadable_texcoords.count > 0) {
    add(NoteSeverity::kNote, "texcoords_unreadable",
        absl::StrCat(Count(unreadable_texcoords.count, "texture coordinate", "texture coordinates"),
                     " unreadable, taken as 0 0", Place(unreadable_texcoords)));
  }
  if (foreign_names.count > 0) {
    add(NoteSeverity::kNote, "names_not_utf8",
        absl::StrCat(Count(foreign_names.count, "name is", "names are"),
                     " not UTF-8 and taken as Latin-1", Place(foreign_names)));
  }
  if (free_forms.count > 0) {
    add(NoteSeverity::kWarning, "surfaces_left_out",
        absl::StrCat("free-form curves and surfaces are not read: export them as a mesh",
                     Place(free_forms)));
  }
  if (std::string dropped = DescribeDropped(*this); !dropped.empty()) {
    add(NoteSeverity::kNote, "not_kept", std::move(dropped));
  }
  return notes;
}

}  // namespace pleat
