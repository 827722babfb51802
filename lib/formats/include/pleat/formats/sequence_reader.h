// The one way in for mesh sequences: a folder, a glob, a single mesh, a point cache, or Pleat's own
// file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/formats/npz.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct ReadSequenceOptions {
  // Unset: the rate of the input where it has one (.pseq, .abc, .mdd, .npz), otherwise 30 fps. The
  // "rate" of a point cache is frames of its host's timeline per sample; it is named in a note and
  // not used.
  std::optional<FrameRate> frame_rate{};
  // The object of an Alembic archive that is read: a mesh, or one with meshes below it. Empty: all
  // meshes that move. A note says when the input is no archive.
  std::string object{};
  // The animation of a glTF file that is read: its name, or its number from 0. Empty: the first
  // that moves something. A note says when the input is no glTF file.
  std::string animation{};
  NpzKeys npz_keys{};  // the names of the arrays in an .npz
  MeshLimits limits{};
  // The threads that read folders and globs, 0 = one per core. The result does not depend on it.
  int num_threads = 0;
  // Reads .drc files and is called by several threads at once. Without it they are refused, because
  // Draco's decoder needs a process of its own, which a library does not start.
  std::function<absl::StatusOr<MeshFile>(const std::string& path)> read_draco{};
};

// Reads `input`, which is one of
// - a folder of .obj, .ply or .drc files (of .glb or .gltf where there are no others), or a folder
//   with one .pc2 and its mesh, or with one .abc
// - a glob of such files ("dir/frame_*.obj")
// - one .obj, .ply, .drc, .glb or .gltf, which is a sequence of one frame
// - a .pc2, whose mesh is the .obj or .ply of the same stem, or template.obj or template.ply, or
//   the only mesh of the folder with the right number of vertices, in this order
// - an Alembic archive (.abc), whose meshes that move are joined
// - an .mdd, an .npz without faces or an .npy, whose mesh is found as that of a .pc2; an .npz with
//   faces, which needs none
// - a Pleat sequence file (.pseq).
//
// Topology and appearance are those of the first frame. The errors name the file and the fault: the
// first frame whose connectivity differs and its first face that differs, numbers that are there
// twice, the frame and vertex of a NaN, wrong counts, empty files, unknown extensions. What does
// not matter is left out or decided, and `report` (may be null) says so (docs/formats/mesh.md).
absl::StatusOr<MeshSequence> ReadSequence(const std::string& input,
                                          const ReadSequenceOptions& options = {},
                                          const Progress& progress = {},
                                          InputReport* report = nullptr);

}  // namespace pleat
