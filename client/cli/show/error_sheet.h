// Heat maps: what skinning and the learned character make of a sequence, colored by vertex error.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/render/color_scale.h"

namespace pleat {

// One animation against the truth.
struct ErrorColumn {
  std::string label;
  MeshSequence sequence;  // the same frames as the truth, in its order
};

struct ErrorSheetOptions {
  double scale_mm = 25;  // the end of the color scale; larger errors have its last color
  double azimuth_degrees = 0;
  int tile_width = 260, tile_height = 340;  // pixels
};

// Returns the scale from 0 to scale_mm, which is the same for every picture that is made with it.
ColorScale ErrorScale(double scale_mm);

// Returns the distance of every vertex from its place in the truth, as a color. Both are 3 x V,
// meters.
std::vector<Rgb> ErrorColors(const ColorScale& scale,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& truth);

// Returns a PNG with a row for each frame and a column for each of `columns`, whose tiles name the
// mean and the largest error. The last column is the truth, without colors. frame_numbers: what the
// frames of `truth` are called in the picture. kInvalidArgument when sizes differ.
absl::StatusOr<std::string> RenderErrorSheet(const MeshSequence& truth,
                                             const std::vector<int>& frame_numbers,
                                             const std::vector<ErrorColumn>& columns,
                                             const ErrorSheetOptions& options);

}  // namespace pleat
