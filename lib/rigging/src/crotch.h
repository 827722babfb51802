// Where the legs of a body part.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pleat/geometry/distance_field.h"

namespace pleat {

// Returns the height at which the legs of a placed skeleton part, where the surface shows it: none
// under a skirt, whose hem is far wider than the legs below it, and none where the legs touch down
// to the feet. field: of the body in its own axes; joints: 3 x 18, template order, stood upright by
// `upright_from_input`; height: of the body.
std::optional<double> CrotchHeight(const DistanceField& field,
                                   const Eigen::Matrix3d& upright_from_input,
                                   const Eigen::Matrix3Xd& joints, double height);

}  // namespace pleat
