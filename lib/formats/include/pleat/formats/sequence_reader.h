// The one door for mesh sequences: a folder, a glob, a single mesh, a point cache, or Pleat's own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct ReadSequenceOptions {
  // Unset: what the input says (.pseq), else 30 fps. A point cache's "rate" is samples per frame of
  // its host's timeline, not a frame rate, and is not used.
  std::optional<FrameRate> frame_rate{};
  MeshLimits limits{};
  int num_threads =
      0;  // for folders and globs; 0 = one per core. The result does not depend on it.
  // Reads .drc files, from several threads; without it they are refused: Draco's decoder needs a
  // process of its own, which a library does not start.
  std::function<absl::StatusOr<MeshFile>(const std::string& path)> read_draco{};
};

// `input` is one of
// - a folder of .obj, .ply or .drc files (or with one .pc2 and its mesh), or a glob
// ("dir/frame_*.obj")
// - one .obj, .ply or .drc: a sequence of one frame
// - a .pc2, whose mesh is the .obj or .ply of the same stem, else template.obj, else the only .obj
//   of the folder with the right number of vertices
// - a Pleat sequence file (.pseq).
// Topology and appearance are those of the first frame. Each fault is named with its file: the
// first frame whose connectivity differs and its first differing face, missing or doubled numbers,
// NaN with frame and vertex, wrong counts, empty files, unknown extensions.
absl::StatusOr<MeshSequence> ReadSequence(const std::string& input,
                                          const ReadSequenceOptions& options = {},
                                          const Progress& progress = {});

}  // namespace pleat
