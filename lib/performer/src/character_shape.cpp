// The body is a smooth union of simple solids. Distances are approximate: exact for capsules of one
// radius, to first order for ellipsoids (Taubin 1994), and lower in the blends. The isosurface
// needs only their zero set, and remeshing corrects what the slope is off.
#include "character_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interpolation.h"
#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

constexpr double kSkirtBlend = .010;  // rounds the seam between skirt and body

// Polynomial smooth minimum: differs from std::min only where the two are closer than `width`.
double SmoothMin(double a, double b, double width) {
  const double overlap = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - overlap * overlap * width / 4;
}

double SmoothMax(double a, double b, double width) { return -SmoothMin(-a, -b, width); }

ShapePart Capsule(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b,
                  double blend) {
  ShapePart part;
  part.kind = ShapePart::Kind::kCapsule;
  part.a = a;
  part.b = b;
  part.radius_a = radius_a;
  part.radius_b = radius_b;
  part.blend = blend;
  return part;
}

ShapePart Ellipsoid(const Vector3d& center, const Vector3d& radii, double blend,
                    const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity()) {
  ShapePart part;
  part.kind = ShapePart::Kind::kEllipsoid;
  part.a = part.b = center;
  part.radii = radii;
  part.axes = axes;
  part.blend = blend;
  return part;
}

// Parts join one after the other, each with its own width, so their order in a list matters a
// little.
double UnionDistance(const std::vector<ShapePart>& parts, const Vector3d& p) {
  double distance = parts[0].Distance(p);
  for (size_t i = 1; i < parts.size(); ++i) {
    distance = SmoothMin(distance, parts[i].Distance(p), parts[i].blend);
  }
  return distance;
}

// Returns the template with proportions of its own: shoulder width, arm length, stance.
Skeleton VaryTemplate(Random& random) {
  const double shoulders = random.Uniform(.96, 1.05);
  const double arms = random.Uniform(.97, 1.04);
  const double stance = random.Uniform(.96, 1.06);
  Eigen::Matrix3Xd joints = HumanTemplate().RestPositions();
  for (int side = 0; side < 2; ++side) {
    const int arm = side == 0 ? kLeftUpperArm : kRightUpperArm;
    const Vector3d shoulder = joints.col(arm);
    for (int j = arm; j < arm + 3; ++j) {
      const Vector3d along = arms * (joints.col(j) - shoulder);
      joints.col(j) = shoulder.cwiseProduct(Vector3d(shoulders, 1, 1)) + along;
    }
    const int leg = side == 0 ? kLeftUpperLeg : kRightUpperLeg;
    for (int j = leg; j < leg + 4; ++j) joints(0, j) *= stance;
  }
  return HumanTemplate().WithRestPositions(joints);
}

}  // namespace

double ShapePart::Distance(const Vector3d& p) const {
  if (kind == Kind::kCapsule) {
    const Vector3d axis = b - a;
    const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    return (p - a - t * axis).norm() - (radius_a + t * (radius_b - radius_a));
  }
  const Vector3d local = axes.transpose() * (p - a);
  const Vector3d scaled = local.cwiseQuotient(radii);
  const double level = scaled.norm();
  const double slope = scaled.cwiseQuotient(radii).norm();
  return slope > 1e-12 ? level * (level - 1) / slope : -radii.minCoeff();
}

double SkirtShape::Radius(double theta, double s) const {
  const double clamped = std::clamp(s, 0.0, 1.2);
  const Eigen::Vector2d radii = waist_radii + std::pow(clamped, bell) * (hem_radii - waist_radii);
  const double ellipse = 1 / std::hypot(std::sin(theta) / radii.x(), std::cos(theta) / radii.y());
  const double fold =
      fold_depth * std::pow(std::min(clamped, 1.0), 1.5) * std::cos(num_folds * theta + fold_phase);
  return ellipse * (1 + fold);
}

Vector3d SkirtShape::Point(double theta, double s) const {
  const double radius = Radius(theta, s);
  return {radius * std::sin(theta), waist_y + s * (hem_y - waist_y),
          center_z + radius * std::cos(theta)};
}

// Negative inside of the bell, which is a solid with a hollow underside. Radial distances are
// reduced by the slope of the flare to be about true distances.
double SkirtShape::Distance(const Vector3d& p) const {
  const double above = p.y() - waist_y, below = hem_y - p.y();
  const double radial = std::hypot(p.x(), p.z() - center_z);
  const double far = std::max({above, below, radial - 1.2 * hem_radii.maxCoeff()});
  if (far > .05) return far;  // away from the surface any lower bound serves
  const double theta = std::atan2(p.x(), p.z() - center_z);
  const double s = Fraction(p.y());
  const double radius = Radius(theta, s);
  const double outer = .92 * (radial - radius);  // .92: cosine of the mean flare
  // The underside is hollow: it rises from the hem towards the legs, so that the surface of the
  // skirt and that of the legs are one closed surface of genus 0.
  const double inward = 1 - std::min(radial / radius, 1.0);
  const double underside = below + .03 * Smoothstep(0, .6, inward);
  return SmoothMax(SmoothMax(outer, above, .012), underside, .030);
}

CharacterShape::CharacterShape(uint64_t character_seed) : skeleton_(HumanTemplate()) {
  Random random(character_seed ^ 0x70657266726d72ull);
  skeleton_ = VaryTemplate(random);
  const double girth = random.Uniform(.93, 1.07);
  AddTorso(girth);
  for (int side = 0; side < 2; ++side) {
    AddArm(side, girth);
    AddLeg(side, girth);
  }
  skirt_.waist_radii *= girth;
  skirt_.hem_radii *= random.Uniform(.94, 1.08);
  skirt_.hem_y = random.Uniform(.315, .350);
  skirt_.num_folds = 8 + random.UniformInt(4);
  skirt_.fold_phase = random.Uniform(0, 2 * std::numbers::pi);
  skirt_.fold_depth = random.Uniform(.035, .055);
}

void CharacterShape::AddTorso(double girth) {
  std::vector<ShapePart>& parts = parts_[static_cast<int>(BodyRegion::kTorso)];
  const Vector3d left = skeleton_.rest_position(kLeftUpperArm);
  const Vector3d right = skeleton_.rest_position(kRightUpperArm);
  const Vector3d inward(.88, 1, .9);  // the shoulders' bar ends inside the arms
  const auto wide = [girth](double x, double y, double z) {
    return Vector3d(girth * x, y, girth * z);
  };
  parts = {
      Ellipsoid({0, .520, -.006}, wide(.086, .075, .066), .02),    // pelvis
      Ellipsoid({0, .630, -.004}, wide(.064, .085, .046), .04),    // waist
      Ellipsoid({0, .718, -.014}, wide(.076, .085, .054), .04),    // ribs
      Ellipsoid({.033, .728, .020}, wide(.033, .034, .031), .03),  // bust
      Ellipsoid({-.033, .728, .020}, wide(.033, .034, .031), .03),
      Capsule(inward.cwiseProduct(left), inward.cwiseProduct(right), .027 * girth, .027 * girth,
              .035),                                                 // shoulders
      Capsule({0, .795, -.022}, {0, .880, -.008}, .030, .026, .03),  // neck
      Ellipsoid({0, .930, .002}, {.047, .066, .056}, .012),          // skull
      Ellipsoid({0, .893, .020}, {.030, .030, .034}, .02),           // jaw
      Ellipsoid({0, .915, .058}, {.008, .013, .010}, .012),          // nose
      Ellipsoid({0, .952, -.058}, {.026, .026, .024}, .014),         // hair bun
  };
}

void CharacterShape::AddArm(int side, double girth) {
  const int first = side == 0 ? kLeftUpperArm : kRightUpperArm;
  const Vector3d shoulder = skeleton_.rest_position(first);
  const Vector3d elbow = skeleton_.rest_position(first + 1);
  const Vector3d hand = skeleton_.rest_position(first + 2);
  const Vector3d along = (hand - elbow).normalized();
  const Vector3d wrist = hand - .018 * along;
  // Palms face the body: thin across, long along the forearm, broad in front-back direction.
  Eigen::Matrix3d axes;
  axes.col(0) = along;
  axes.col(1) = along.cross(Vector3d::UnitX()).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const double front = axes.col(1).z() > 0 ? 1 : -1;
  const Vector3d thumb_root = hand - .004 * along + .014 * front * axes.col(1);
  parts_[static_cast<int>(BodyRegion::kLeftArm) + side] = {
      Capsule(shoulder, elbow, .0270 * girth, .0205 * girth, .02),
      Capsule(elbow, elbow + .35 * (wrist - elbow), .0200 * girth, .0205 * girth, .006),
      Capsule(elbow + .35 * (wrist - elbow), wrist, .0205 * girth, .0140, .006),
      Ellipsoid(hand + .016 * along, {.042, .021, .0120}, .012, axes),
      Capsule(thumb_root, thumb_root + .020 * along + .012 * front * axes.col(1), .0090, .0075,
              .010),
  };
}

void CharacterShape::AddLeg(int side, double girth) {
  const int first = side == 0 ? kLeftUpperLeg : kRightUpperLeg;
  const Vector3d hip = skeleton_.rest_position(first);
  const Vector3d knee = skeleton_.rest_position(first + 1);
  const Vector3d ankle = skeleton_.rest_position(first + 2);
  const Vector3d toes = skeleton_.rest_position(first + 3);
  const Vector3d calf = knee + .35 * (ankle - knee) + Vector3d(0, 0, -.006);
  const Vector3d ball = toes + Vector3d(0, -.003, -.012);
  parts_[static_cast<int>(BodyRegion::kLeftLeg) + side] = {
      Capsule(hip, knee, .046 * girth, .0300 * girth, .02),
      Capsule(knee, calf, .0285 * girth, .0315 * girth, .006),
      Capsule(calf, ankle + Vector3d(0, .012, 0), .0315 * girth, .0190, .006),
      Capsule(ankle + Vector3d(0, -.006, -.008), ball, .0220, .0200, .018),
      Ellipsoid(ball + Vector3d(0, -.002, .012), {.0270, .0165, .0340}, .012),
  };
}

double CharacterShape::RegionDistance(BodyRegion region, const Vector3d& p) const {
  if (region == BodyRegion::kSkirt) return skirt_.Distance(p);
  return UnionDistance(parts_[static_cast<int>(region)], p);
}

double CharacterShape::LegDistance(const Vector3d& p) const {
  return std::min(RegionDistance(BodyRegion::kLeftLeg, p),
                  RegionDistance(BodyRegion::kRightLeg, p));
}

double CharacterShape::Distance(const Vector3d& p) const {
  double distance = RegionDistance(BodyRegion::kTorso, p);
  distance = SmoothMin(distance, RegionDistance(BodyRegion::kLeftArm, p), .022);
  distance = SmoothMin(distance, RegionDistance(BodyRegion::kRightArm, p), .022);
  distance = SmoothMin(distance, LegDistance(p), .02);
  distance = SmoothMin(distance, skirt_.Distance(p), kSkirtBlend);
  return SmoothMax(distance, -p.y(), .006);  // flat soles
}

BodyRegion CharacterShape::NearestRegion(const Vector3d& p) const {
  BodyRegion nearest = BodyRegion::kTorso;
  double best = RegionDistance(nearest, p);
  for (int r = 1; r <= static_cast<int>(BodyRegion::kSkirt); ++r) {
    const double distance = RegionDistance(static_cast<BodyRegion>(r), p);
    if (distance < best) {
      best = distance;
      nearest = static_cast<BodyRegion>(r);
    }
  }
  return nearest;
}

double CharacterShape::SkirtShare(const Vector3d& p) const {
  const double s = skirt_.Fraction(p.y());
  if (s <= 0 || s > 1.2) return 0;
  const double on_skirt = 1 - Smoothstep(.006, .012, std::abs(skirt_.Distance(p)));
  if (on_skirt <= 0) return 0;
  const double radial = std::hypot(p.x(), p.z() - skirt_.center_z);
  const double theta = std::atan2(p.x(), p.z() - skirt_.center_z);
  const double across = radial / skirt_.Radius(theta, s);
  return on_skirt * Smoothstep(.002, .035, LegDistance(p)) * Smoothstep(.30, .92, across);
}

double CharacterShape::RelativeEdgeLength(const Vector3d& p) const {
  const double arm = Smoothstep(.12, .16, std::abs(p.x())) * Smoothstep(.45, .50, p.y());
  const double hand = Smoothstep(.215, .245, std::abs(p.x())) * arm;
  const double head = Smoothstep(.82, .87, p.y());
  const double leg = 1 - Smoothstep(skirt_.hem_y - .04, skirt_.hem_y, p.y());
  const double foot = 1 - Smoothstep(.05, .09, p.y());
  return 1 - std::max({.30 * arm + .15 * hand, .30 * head, .22 * leg + .18 * foot});
}

}  // namespace pleat
