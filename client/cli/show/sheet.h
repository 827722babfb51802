// Contact sheets: frames of several animations of one character as rows of small pictures.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct SheetRow {
  std::string label;
  MeshSequence sequence;
};

struct SheetOptions {
  std::vector<int> frames;  // the frames that are shown; empty = `count` evenly spaced ones
  int count = 8;
  double azimuth_degrees = 0;               // 0 shows the side that faces +z
  int tile_width = 200, tile_height = 300;  // pixels
};

// Returns `count` evenly spaced frames of `num_frames`, including the first and the last.
std::vector<int> SpacedFrames(int num_frames, int count);

// Turns "0,5,9" into {0, 5, 9}. Everything else is a usage error.
absl::StatusOr<std::vector<int>> ParseFrameList(const std::string& text);

// Returns the sheet as a PNG. Evenly spaced frames are taken from those that all rows have.
// kInvalidArgument names a frame that a row does not have.
absl::StatusOr<std::string> RenderSheet(const std::vector<SheetRow>& rows,
                                        const SheetOptions& options);

}  // namespace pleat
