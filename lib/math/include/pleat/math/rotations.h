// Rotations of three-space: exponential maps, unwrapping, Euler angles, projections.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pleat {

// The cross-product matrix [v]x.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

// Exponential map (radians * unit axis) -> rotation (Rodrigues), exact near zero.
Eigen::Quaterniond QuaternionFromExponentialMap(const Eigen::Vector3d& w);

// Rotation -> exponential map of angle in [0, pi].
Eigen::Vector3d ExponentialMapFromQuaternion(const Eigen::Quaterniond& rotation);

// Of all exponential maps w + 2 pi k w/|w| of the same rotation, the one nearest to `reference`.
// Chained along time it removes the wraps at 2 pi.
Eigen::Vector3d UnwrapExponentialMap(const Eigen::Vector3d& w, const Eigen::Vector3d& reference);

// Intrinsic X-Y-Z Euler angles, radians: R = Rx(a) Ry(b) Rz(c), b in [-pi/2, pi/2].
Eigen::Vector3d EulerXyzFromRotation(const Eigen::Matrix3d& rotation);
Eigen::Matrix3d RotationFromEulerXyz(const Eigen::Vector3d& angles);

// The rotation nearest to `matrix` in the Frobenius norm (SVD, determinant +1).
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace pleat
