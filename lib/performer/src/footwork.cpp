#include "footwork.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interpolation.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

int Ankle(int side) { return side == 0 ? kLeftFoot : kRightFoot; }

double Wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

// Returns a bump of height 1 at `center` of a cycle, zero from `width` away.
double CycleBump(double cycle_part, double center, double width) {
  const double away = std::abs(std::remainder(cycle_part - center, 1.0)) / width;
  return away < 1 ? std::pow(std::cos(away * std::numbers::pi / 2), 2) : 0;
}

}  // namespace

Footwork::Footwork(const Skeleton& skeleton, const Course& course, double heel_rise_rad)
    : skeleton_(skeleton), course_(course), heel_rise_rad_(heel_rise_rad) {
  const int num_cycles = static_cast<int>(std::floor(course.cycles.back())) + 4;
  for (int side = 0; side < 2; ++side) {
    for (int cycle = -1; cycle < num_cycles; ++cycle) {
      spots_[side].push_back(PlanSpot(side, cycle));
    }
  }
}

// A foot stands where it is right below the hips at the middle of its stance; that instant is
// looked up on the course, which reaches beyond the end of the motion for this.
Footwork::Spot Footwork::PlanSpot(int side, int cycle) const {
  const Vector3d rest = skeleton_.rest_position(Ankle(side));
  if (cycle <= std::floor(kStart[side])) return {rest, 0};  // where the foot stands at the start
  const double middle = cycle + kStance / 2 - kStart[side];
  const auto reached = std::lower_bound(course_.cycles.begin(), course_.cycles.end() - 1, middle);
  const int t = static_cast<int>(reached - course_.cycles.begin());
  const double yaw = course_.heading[t];
  Vector3d place = rest - skeleton_.rest_position(0) + course_.offsets[side][t];
  place = AngleAxisd(yaw, Vector3d::UnitY()) * place + course_.path[t];
  place.y() = rest.y();
  return {place, yaw};
}

FootTarget Footwork::At(int side, int t) const {
  const double position = course_.cycles[t] + kStart[side];
  const int cycle = static_cast<int>(std::floor(position));
  const double part = position - cycle;
  const Spot& from = spots_[side][cycle + 1];
  const Spot& to = spots_[side][cycle + 2];
  const double stance = 1 - (1 - kStance) * course_.liveliness[t];
  const double swing = part > stance ? (part - stance) / (1 - stance) : 0;
  const double done = Smoothstep(0, 1, swing);
  FootTarget target;
  target.ankle = from.ankle + done * (to.ankle - from.ankle);
  target.ankle.y() += course_.lift[t] * std::pow(std::sin(std::numbers::pi * swing), 2);
  target.yaw = from.yaw + done * (to.yaw - from.yaw);
  // The heel leaves the floor before the swing and meets it first after it.
  target.pitch = course_.liveliness[t] * (heel_rise_rad_ * CycleBump(part, kStance + .02, .24) -
                                          .35 * heel_rise_rad_ * CycleBump(part, .99, .10));
  if (target.pitch > 0) {  // about the toes
    const double length =
        (skeleton_.rest_position(Ankle(side) + 1) - skeleton_.rest_position(Ankle(side))).norm();
    target.ankle += length * (Vector3d::UnitY() * std::sin(target.pitch) +
                              Vector3d(std::sin(target.yaw), 0, std::cos(target.yaw)) *
                                  (1 - std::cos(target.pitch)));
  }
  return target;
}

Quaterniond LegAngles::Thigh() const {
  return Quaterniond(AngleAxisd(abduction, Vector3d::UnitZ()) *
                     AngleAxisd(-flexion, Vector3d::UnitX()));
}

Quaterniond LegAngles::Knee() const { return Quaterniond(AngleAxisd(knee, Vector3d::UnitX())); }

LegAngles SolveLeg(const Vector3d& thigh, const Vector3d& shin, const Vector3d& ankle) {
  LegAngles angles;
  // |thigh + Rx(knee) shin|^2 = |ankle|^2 is b cos(knee) + c sin(knee) = d.
  const double b = thigh.y() * shin.y() + thigh.z() * shin.z();
  const double c = thigh.z() * shin.y() - thigh.y() * shin.z();
  const double d =
      (ankle.squaredNorm() - thigh.squaredNorm() - shin.squaredNorm()) / 2 - thigh.x() * shin.x();
  angles.knee = Wrapped(std::atan2(c, b) + std::acos(std::clamp(d / std::hypot(b, c), -1.0, 1.0)));
  const Vector3d leg = thigh + AngleAxisd(angles.knee, Vector3d::UnitX()) * shin;
  // First Rx turns the leg to the wanted z, then Rz to the wanted x and y.
  const Vector3d wanted = ankle * (leg.norm() / std::max(ankle.norm(), 1e-9));
  const double radius = std::hypot(leg.y(), leg.z());
  const double z = std::clamp(wanted.z(), -radius, radius);
  const double y = -std::sqrt(radius * radius - z * z);
  angles.flexion = -Wrapped(std::atan2(z, y) - std::atan2(leg.z(), leg.y()));
  angles.abduction = Wrapped(std::atan2(wanted.y(), wanted.x()) - std::atan2(y, leg.x()));
  return angles;
}

}  // namespace pleat
