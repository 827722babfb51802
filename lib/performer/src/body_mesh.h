// The performer's rest mesh and its skinning weights.
#pragma once

#include "character_shape.h"
#include "isosurface.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

// Builds a closed mesh of genus 0 with about `num_vertices` vertices, in units of body height. The
// error is kInternal when the surface is not closed or not in one piece, and kCancelled.
absl::StatusOr<TriangleSoup> BuildBodyMesh(const CharacterShape& shape, int num_vertices,
                                           const Progress& progress);

// Builds smooth weights with at most four influences: bones assigned by region, diffused over the
// surface.
absl::StatusOr<SkinWeights> BuildBodyWeights(const CharacterShape& shape, const TriangleSoup& mesh);

// Returns the weights of a point of the skirt before diffusion, num_joints values of sum 1. x: to
// the left; s: 0 waist .. 1 hem; off_leg: 1 on the bell, falling to 0 where the underside meets a
// leg.
Eigen::VectorXd SkirtBoneWeights(double x, double s, double off_leg);

}  // namespace pleat
