#include "motion_segment.h"

#include <algorithm>
#include <cmath>

#include "pleat/base/status.h"

namespace pleat {
namespace {

// Of a quaternion of any length; the identity for zero.
Eigen::Matrix3f RotationOf(double w, double x, double y, double z) {
  const double square = w * w + x * x + y * y + z * z;
  if (!(square > 1e-20)) return Eigen::Matrix3f::Identity();
  const double s = 2 / square;
  Eigen::Matrix3d rotation;
  rotation << 1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),
      s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), s * (x * z - y * w),
      s * (y * z + x * w), 1 - s * (x * x + y * y);
  return rotation.cast<float>();
}

// sums[c][t] = sum_k weights(k, t) * row[3 k + c] for the frames of one group.
void SumComponents(const float* row, const float* weights, Eigen::Index stride, int num_components,
                   float sums[3][kGroupFrames]) {
  float x[kGroupFrames] = {}, y[kGroupFrames] = {}, z[kGroupFrames] = {};
  for (int k = 0; k < num_components; ++k) {
    const float* w = weights + k * stride;
    const float bx = row[3 * k], by = row[3 * k + 1], bz = row[3 * k + 2];
    for (int t = 0; t < kGroupFrames; ++t) {
      x[t] += bx * w[t];
      y[t] += by * w[t];
      z[t] += bz * w[t];
    }
  }
  std::copy_n(x, kGroupFrames, sums[0]);
  std::copy_n(y, kGroupFrames, sums[1]);
  std::copy_n(z, kGroupFrames, sums[2]);
}

}  // namespace

absl::Status CodeRigidMotion(const MotionSteps& steps, BinaryCoder* coder, TrajectoryMatrix* rigid,
                             MotionSegment* segment) {
  Eigen::VectorXd row_steps(7);
  row_steps << Eigen::Vector4d::Constant(steps.rotation),
      Eigen::Vector3d::Constant(steps.translation_m);
  rigid->conservativeResize(7, segment->num_frames);
  PLEAT_RETURN_IF_ERROR(CodeTrajectories(row_steps, coder, rigid));
  segment->rotations.resize(segment->num_frames);
  segment->translations.resize(segment->num_frames);
  for (int t = 0; t < segment->num_frames; ++t) {
    segment->rotations[t] =
        RotationOf((*rigid)(0, t), (*rigid)(1, t), (*rigid)(2, t), (*rigid)(3, t));
    segment->translations[t] = rigid->col(t).tail<3>().cast<float>();
  }
  return absl::OkStatus();
}

absl::Status CodeWeights(const MotionSteps& steps, BinaryCoder* coder, TrajectoryMatrix* rows,
                         MotionSegment* segment) {
  rows->conservativeResize(segment->num_components, segment->num_frames);
  PLEAT_RETURN_IF_ERROR(CodeTrajectories(
      Eigen::VectorXd::Constant(segment->num_components, steps.field_m), coder, rows));
  segment->weights.setZero(segment->num_components, segment->num_groups() * kGroupFrames);
  for (int k = 0; k < segment->num_components; ++k) {
    double square = 0;
    for (int t = 0; t < segment->num_frames; ++t) square += (*rows)(k, t) * (*rows)(k, t);
    const double norm = square > 0 ? std::sqrt(square) : 1;
    for (int t = 0; t < segment->num_frames; ++t) {
      (*rows)(k, t) /= norm;
      segment->weights(k, t) = static_cast<float>((*rows)(k, t));
    }
  }
  return absl::OkStatus();
}

void EvaluateGroup(const Eigen::Matrix3Xf& rest, const MotionSegment& segment, int group,
                   std::vector<Eigen::Matrix3Xf>* frames) {
  const int first = group * kGroupFrames;
  const int count = std::min(kGroupFrames, segment.num_frames - first);
  const Eigen::Index num_vertices = rest.cols();
  frames->resize(count);
  for (Eigen::Matrix3Xf& frame : *frames) frame.resize(3, num_vertices);
  float turns[9][kGroupFrames] = {}, shifts[3][kGroupFrames] = {};
  for (int t = 0; t < count; ++t) {
    for (int i = 0; i < 9; ++i) turns[i][t] = segment.rotations[first + t](i / 3, i % 3);
    for (int c = 0; c < 3; ++c) shifts[c][t] = segment.translations[first + t][c];
  }
  const float* weights = segment.num_components > 0 ? &segment.weights.coeff(0, first) : nullptr;
  float sums[3][kGroupFrames], moved[3][kGroupFrames];
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    const float* row = segment.num_components > 0 ? &segment.fields.coeff(v, 0) : nullptr;
    SumComponents(row, weights, segment.weights.cols(), segment.num_components, sums);
    for (int c = 0; c < 3; ++c) {
      for (int t = 0; t < kGroupFrames; ++t) sums[c][t] += rest(c, v);
    }
    for (int c = 0; c < 3; ++c) {
      for (int t = 0; t < kGroupFrames; ++t) {
        moved[c][t] = turns[3 * c][t] * sums[0][t] + turns[3 * c + 1][t] * sums[1][t] +
                      turns[3 * c + 2][t] * sums[2][t] + shifts[c][t];
      }
    }
    for (int t = 0; t < count; ++t) {
      (*frames)[t].col(v) << moved[0][t], moved[1][t], moved[2][t];
    }
  }
}

}  // namespace pleat
