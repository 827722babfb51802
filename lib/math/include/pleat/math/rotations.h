// Rotations of three-space: exponential maps, unwrapping, Euler angles, projections.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pleat {

// Returns the cross-product matrix [v]x, with [v]x y = v cross y.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

// Returns the rotation of an exponential map (radians * unit axis) by the formula of Rodrigues,
// exact near zero. The quaternion is of unit length up to rounding.
Eigen::Quaterniond QuaternionFromExponentialMap(const Eigen::Vector3d& w);

// Returns the exponential map of a rotation, with an angle in [0, pi].
Eigen::Vector3d ExponentialMapFromQuaternion(const Eigen::Quaterniond& rotation);

// Returns the one nearest to `reference` among all exponential maps w + 2 pi k w/|w| of the same
// rotation. Chained along time it removes the wraps at 2 pi (docs/method/fit.md#representation).
Eigen::Vector3d UnwrapExponentialMap(const Eigen::Vector3d& w, const Eigen::Vector3d& reference);

// Intrinsic X-Y-Z Euler angles in radians: R = Rx(a) Ry(b) Rz(c) with b in [-pi/2, pi/2].
Eigen::Vector3d EulerXyzFromRotation(const Eigen::Matrix3d& rotation);
Eigen::Matrix3d RotationFromEulerXyz(const Eigen::Vector3d& angles);

// Returns the rotation nearest to `matrix` in the Frobenius norm (by SVD, with determinant +1).
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace pleat
