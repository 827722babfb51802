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
  std::vector<int> frames;  // shown frames; empty = `count` evenly spaced ones
  int count = 8;
  double azimuth_degrees = 0;               // 0 looks at the side that faces +z
  int tile_width = 200, tile_height = 300;  // pixels
};

// `count` evenly spaced frames of `num_frames`, first and last included.
std::vector<int> SpacedFrames(int num_frames, int count);

// "0,5,9" -> {0, 5, 9}; a usage error otherwise.
absl::StatusOr<std::vector<int>> ParseFrameList(const std::string& text);

// PNG bytes. The frames of rows that are shorter are taken from those that all rows have.
// kInvalidArgument names a frame that a row does not have.
absl::StatusOr<std::string> RenderSheet(const std::vector<SheetRow>& rows,
                                        const SheetOptions& options);

}  // namespace pleat
