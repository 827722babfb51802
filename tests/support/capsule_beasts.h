// Animals of capsules, in meters, standing on the floor; their heads point towards +z.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "support/triangle_shapes.h"

namespace pleat {

// A four-legged animal. Lengths are shares of the trunk's, which is 1 m.
struct CapsuleBeastOptions {
  double trunk_radius = .2;
  double leg = .85;  // from shoulder or hip to the floor
  double leg_radius = .06;
  double neck = .5;
  double neck_degrees = 55;  // above the horizon
  double head = .35;
  double tail = .4;
  // It stands on its hind legs: the trunk rises by so much about the hips and the forelegs hang at
  // `foreleg_degrees` before the vertical.
  double rear_degrees = 0;
  double foreleg_degrees = 0;
};

inline std::vector<Capsule> CapsuleBeastParts(const CapsuleBeastOptions& options) {
  const auto in_plane = [](double degrees_above_z) {
    const double angle = degrees_above_z * EIGEN_PI / 180;
    return Eigen::Vector3d(0, std::sin(angle), std::cos(angle));
  };
  const Eigen::Vector3d hips(0, options.leg, 0);
  const Eigen::Vector3d along = in_plane(options.rear_degrees);
  const Eigen::Vector3d shoulders = hips + along;
  // A rearing animal keeps its head level.
  const Eigen::Vector3d neck_end =
      shoulders + options.neck * in_plane(options.neck_degrees + .5 * options.rear_degrees);
  const double thin = .7 * options.leg_radius;
  std::vector<Capsule> parts = {
      {hips, shoulders, options.trunk_radius, 1.1 * options.trunk_radius},
      {shoulders, neck_end, .6 * options.trunk_radius, .4 * options.trunk_radius},
      {neck_end, neck_end + options.head * in_plane(-30), .4 * options.trunk_radius,
       .2 * options.trunk_radius}};
  if (options.tail > 0) {
    parts.push_back({hips - options.trunk_radius * along,
                     hips - options.trunk_radius * along - options.tail * in_plane(60), thin,
                     thin});
  }
  for (const double side : {-1., 1.}) {
    const Eigen::Vector3d out(side * .7 * options.trunk_radius, 0, 0);
    const Eigen::Vector3d foreleg = -in_plane(90 + options.foreleg_degrees);
    const auto add_leg = [&](const Eigen::Vector3d& top, const Eigen::Vector3d& down, double bow) {
      const double length = options.leg - thin;
      const Eigen::Vector3d knee = top + .5 * length * down + Eigen::Vector3d(0, 0, bow);
      const Eigen::Vector3d foot = top + length * down;
      parts.push_back({top, knee, 1.4 * options.leg_radius, options.leg_radius});
      parts.push_back({knee, foot, options.leg_radius, thin});
      parts.push_back({foot, foot + Eigen::Vector3d(0, 0, thin), thin, thin});
    };
    add_leg(hips + out, {0, -1, 0}, .08 * options.leg);
    add_leg(shoulders + out, foreleg, -.05 * options.leg);
  }
  return parts;
}

struct Beast {
  std::string name;
  std::vector<Capsule> parts;
  bool rears = false;  // on its hind legs, so that it comes near to a human
  double cell_m = .03;
};

// What googletest prints of it.
inline void PrintTo(const Beast& beast, std::ostream* out) { *out << beast.name; }

// A horse, a dog and a bear: on four legs, on their hind legs, and turned up as they stand.
inline std::vector<Beast> FourLeggedBeasts() {
  const std::pair<std::string, CapsuleBeastOptions> animals[] = {
      {"horse", {}},
      {"dog", {.trunk_radius = .15, .leg = .6, .leg_radius = .04, .neck = .25, .head = .3}},
      {"bear",
       {.trunk_radius = .28,
        .leg = .6,
        .leg_radius = .1,
        .neck = .3,
        .neck_degrees = 20,
        .head = .4,
        .tail = 0}}};
  std::vector<Beast> beasts;
  for (const auto& [name, animal] : animals) {
    std::vector<Capsule> parts = CapsuleBeastParts(animal);
    beasts.push_back({name, parts});
    const Eigen::Matrix3d up =
        Eigen::AngleAxisd(-EIGEN_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    for (Capsule& part : parts) {
      part.start = up * part.start;
      part.end = up * part.end;
    }
    beasts.push_back({name + ", turned up", parts});
    for (const int rear : {60, 85}) {
      for (const int foreleg : {20, 70}) {
        CapsuleBeastOptions rearing = animal;
        rearing.rear_degrees = rear;
        rearing.foreleg_degrees = foreleg;
        beasts.push_back({name + ", rears " + std::to_string(rear) + " " + std::to_string(foreleg),
                          CapsuleBeastParts(rearing), true});
      }
    }
  }
  return beasts;
}

inline std::vector<Capsule> BirdParts(bool are_wings_spread) {
  std::vector<Capsule> bird = {{{0, .3, 0}, {0, .45, .25}, .13, .1},
                               {{0, .5, .3}, {0, .6, .35}, .06, .06},
                               {{0, .6, .35}, {0, .58, .47}, .03, .01},
                               {{0, .28, -.05}, {0, .25, -.4}, .05, .03}};
  for (const double side : {-1., 1.}) {
    bird.push_back({{side * .07, .25, .03}, {side * .07, .02, .05}, .02, .015});
    bird.push_back({{side * .07, .02, .05}, {side * .07, .02, .13}, .015, .01});
    const Eigen::Vector3d tip = are_wings_spread ? Eigen::Vector3d(side * .7, .5, 0)
                                                 : Eigen::Vector3d(side * .16, .28, -.25);
    bird.push_back({{side * .1, .45, .15}, tip, .05, .02});
  }
  return bird;
}

inline std::vector<Capsule> SpiderParts() {
  std::vector<Capsule> spider = {{{0, .3, -.2}, {0, .3, .2}, .18, .1}};
  for (const double side : {-1., 1.}) {
    for (int k = 0; k < 4; ++k) {
      const double z = .25 * (k - 1.5);
      spider.push_back({{0, .3, .3 * z}, {side * .4, .5, z}, .03, .025});
      spider.push_back({{side * .4, .5, z}, {side * .7, .02, 1.3 * z}, .025, .015});
    }
  }
  return spider;
}

inline std::vector<Capsule> TableParts() {
  std::vector<Capsule> table = {{{-.6, .75, 0}, {.6, .75, 0}, .1, .1}};
  for (const double side : {-.55, .55}) {
    table.push_back({{side, .75, -.3}, {side, .75, .3}, .1, .1});
    for (const double z : {-.3, .3}) table.push_back({{side, .7, z}, {side, .05, z}, .05, .05});
  }
  return table;
}

inline std::vector<Capsule> SnakeParts() {
  std::vector<Capsule> snake;
  const auto at = [](int i) { return Eigen::Vector3d(.3 * std::sin(.9 * i), .05, .15 * i); };
  for (int k = 0; k < 12; ++k) snake.push_back({at(k), at(k + 1), .05, .05});
  return snake;
}

// An arm with its hand.
inline std::vector<Capsule> ArmParts() {
  std::vector<Capsule> arm = {{{0, .1, 0}, {0, .5, 0}, .06, .05},
                              {{0, .5, 0}, {.05, .8, 0}, .05, .03},
                              {{.05, .8, 0}, {.06, .9, 0}, .045, .045}};
  for (int k = -2; k <= 2; ++k) {
    arm.push_back({{.06 + .02 * k, .92, 0}, {.06 + .04 * k, 1.03, 0}, .011, .01});
  }
  return arm;
}

// Hips and legs of a human, without what belongs above them.
inline std::vector<Capsule> LegsParts() {
  std::vector<Capsule> legs = {{{0, .8, 0}, {0, 1, 0}, .12, .12}};
  for (const double side : {-1., 1.}) {
    legs.push_back({{side * .08, .75, 0}, {side * .1, .05, 0}, .07, .05});
    legs.push_back({{side * .1, .04, 0}, {side * .11, .03, .15}, .04, .03});
  }
  return legs;
}

// None of them is a human.
inline std::vector<Beast> CapsuleBeasts() {
  std::vector<Beast> beasts = FourLeggedBeasts();
  beasts.push_back({"bird", BirdParts(false), false, .015});
  beasts.push_back({"bird, wings spread", BirdParts(true), false, .015});
  beasts.push_back({"spider", SpiderParts(), false, .015});
  beasts.push_back({"table", TableParts()});
  beasts.push_back({"snake", SnakeParts()});
  beasts.push_back({"arm", ArmParts(), false, .01});
  beasts.push_back({"legs alone", LegsParts(), false, .02});
  return beasts;
}

}  // namespace pleat
