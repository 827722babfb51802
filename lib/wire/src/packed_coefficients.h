// Many detail coefficients in few bytes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace pleat {

// Coefficients are rounded to this, in meters. The columns of a basis are orthonormal, so a vertex
// moves by far less: .03 mm RMS in a part of 700 vertices with 80 components.
inline constexpr float kCoefficientStep_m = 5e-4f;

// Up to so many are sent as they are.
inline constexpr int kMaxPlainCoefficients = 256;

// Whole steps as zigzag varints, deflated (zlib). Finite coefficients; steps beyond 32 bits are
// clamped.
std::string PackCoefficients(const Eigen::VectorXf& coefficients);

// The inverse, of at most `max_count` coefficients: kInvalidArgument when the bytes are damaged or
// hold more. Never takes memory for more.
absl::StatusOr<Eigen::VectorXf> UnpackCoefficients(std::string_view bytes, int max_count);

}  // namespace pleat
