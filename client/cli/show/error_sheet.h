// Heat maps: what skinning and the learnt character make of a sequence, coloured by vertex error.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/render/colour_scale.h"

namespace pleat {

// One animation against the truth.
struct ErrorColumn {
  std::string label;
  MeshSequence sequence;  // the frames of the truth, in its order
};

struct ErrorSheetOptions {
  double scale_mm = 25;  // the end of the colour scale; larger errors have its last colour
  double azimuth_degrees = 0;
  int tile_width = 260, tile_height = 340;  // pixels
};

// 0 .. scale_mm, the same for every picture made with it.
ColourScale ErrorScale(double scale_mm);

// The distance of every vertex from its place in the truth, as colours. Both 3 x V, metres.
std::vector<Rgb> ErrorColours(const ColourScale& scale,
                              const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                              const Eigen::Ref<const Eigen::Matrix3Xd>& truth);

// PNG bytes: a row for each frame, a column for each of `columns` with its mean and largest error
// in every tile, and the truth last, uncoloured. `frame_numbers` names the frames of `truth`.
// kInvalidArgument when sizes differ.
absl::StatusOr<std::string> RenderErrorSheet(const MeshSequence& truth,
                                             const std::vector<int>& frame_numbers,
                                             const std::vector<ErrorColumn>& columns,
                                             const ErrorSheetOptions& options);

}  // namespace pleat
