// The 18-joint human skeleton placed inside a body.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/embedding_search.h"
#include "pleat/rigging/refinement.h"

namespace pleat {

struct EmbeddingOptions {
  // Facings to try, degrees about +y from +z towards +x. A wrong one costs milliseconds.
  std::vector<double> yaws_degrees = {0, 90, 180, 270};
  int max_spheres = 1000;
  PenaltyOptions penalties;
  SearchOptions search;
  RefinementOptions refinement;
};

// What one facing costs; infinite when the search found nothing.
struct FacingResidual {
  double yaw_degrees;
  double residual;
};

struct Embedding {
  Eigen::Matrix3Xd joints;              // 3 x 18, template order, in the units of the mesh
  Eigen::Matrix3Xd initial_joints;      // the same before the continuous refinement
  double residual = 0;                  // of the search; .03-.10 is doubtful, over .15 is no human
  double yaw_degrees = 0;               // where the character faces
  std::vector<FacingResidual> facings;  // every facing tried, in the order given
  int num_spheres = 0;
};

// Baran and Popovic 2007, "Automatic rigging and animation of 3D characters": sphere packing,
// graph, search over the facings, refinement. kNotFound when the skeleton fits in no facing,
// kInvalidArgument when no facing is given, kCancelled.
absl::StatusOr<Embedding> EmbedSkeleton(const BodyVolume& volume,
                                        const EmbeddingOptions& options = {},
                                        const Progress& progress = {});

}  // namespace pleat
