// Where the legs of a body part.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "pleat/geometry/distance_field.h"

namespace pleat {

// Heights along y.
struct Crotch {
  double height = 0;
  double hips = 0;  // of the legs, as far as the crotch tells
};

// Returns the height at which the legs of a placed skeleton part, where the surface shows it: none
// under a skirt, whose hem is far wider than the legs below it, and none where the legs touch down
// to the feet. field: of the body in its own axes; joints: 3 x 18, template order, stood upright by
// `upright_from_input`; bounds: of the upright body.
std::optional<Crotch> FindCrotch(const DistanceField& field,
                                 const Eigen::Matrix3d& upright_from_input,
                                 const Eigen::Matrix3Xd& joints, const Eigen::AlignedBox3d& bounds);

}  // namespace pleat
