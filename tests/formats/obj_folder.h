// A folder with one OBJ file for each frame.
#pragma once

#include <string>

#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Writes frame_0000.obj, frame_0001.obj, ... into `folder` (made when missing).
inline absl::Status WriteObjFolder(const std::string& folder, const MeshSequence& sequence) {
  for (int t = 0; t < sequence.num_frames(); ++t) {
    PLEAT_RETURN_IF_ERROR(WriteObj(absl::StrFormat("%s/frame_%04d.obj", folder, t),
                                   sequence.topology(), sequence.frame(t), sequence.appearance()));
  }
  return absl::OkStatus();
}

}  // namespace pleat
