// The performer's rest mesh and its skinning weights.
#pragma once

#include "character_shape.h"
#include "isosurface.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

// A closed mesh of genus 0 with about `num_vertices` vertices, in units of body height.
absl::StatusOr<TriangleSoup> BuildBodyMesh(const CharacterShape& shape, int num_vertices,
                                           const Progress& progress);

// Smooth weights with at most four influences: bones assigned by region, diffused over the surface.
absl::StatusOr<SkinWeights> BuildBodyWeights(const CharacterShape& shape, const TriangleSoup& mesh);

// The weights of a point of the bell at (theta, s) before diffusion; `share`: SkirtShare there.
// num_joints values, sum 1.
Eigen::VectorXd SkirtBoneWeights(double x, double s, double share);

}  // namespace pleat
