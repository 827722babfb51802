// The parser behind obj_reader.h, with what frames of one series share.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "obj_notes.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// The text of a file from its first face on. Frames of a series mostly repeat it byte for byte;
// then its faces are those of the first frame and need not be parsed again.
struct ObjFaceText {
  std::string text;  // empty: cannot be recognized, since vertices follow
  int64_t num_vertices = 0, num_texcoords = 0;  // before it; relative indices depend on them
  ObjNotes notes;                               // about this text
};

struct ObjFrame {
  MeshFile mesh;  // without faces and appearance when they are the known ones
  bool has_known_faces = false;
};

// known: may be null; must outlive the call. faces: receives the text of the faces; may be null.
absl::StatusOr<ObjFrame> ParseObj(std::string_view text, const std::string& file,
                                  const MeshLimits& limits, const ObjFaceText* known,
                                  ObjFaceText* faces);

}  // namespace pleat
