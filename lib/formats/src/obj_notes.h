// What an OBJ file holds and Pleat does not take.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pleat/mesh/input_note.h"

namespace pleat {

// Counts things of one kind and keeps the line of the first.
struct LineCount {
  int64_t count = 0;
  int32_t first_line = 0;

  void Add(int32_t line) {
    if (count++ == 0) first_line = line;
  }
  void Add(const LineCount& later) {
    if (count == 0) first_line = later.first_line;
    count += later.count;
  }
};

struct ObjNotes {
  // In the faces, and in statements after the first of them.
  LineCount small_faces;            // of fewer than three corners
  int32_t small_face_corners = -1;  // of each, -1 = different numbers
  LineCount missing_texcoords;      // corners whose texture coordinate is not there
  // Anywhere.
  LineCount unreadable_texcoords;  // statements vt
  LineCount foreign_names;         // that are not UTF-8
  LineCount free_forms;            // curves and surfaces
  int64_t num_groups = 0;          // groups and objects
  int64_t num_lines_and_points = 0;
  bool has_colors = false, has_weights = false, has_normals = false, has_smoothing = false;

  void AddSmallFace(int32_t num_corners, int32_t line);
  // Adds what a later part of the file holds.
  void Add(const ObjNotes& later);
  std::vector<InputNote> ToInputNotes() const;
};

}  // namespace pleat
