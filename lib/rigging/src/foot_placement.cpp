#include "foot_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pleat/rigging/bone_visibility.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Shares of the foot's length in which artists, motion capture and anatomy agree within .06.
constexpr double kAnkleHeight = .33, kAnkleFromHeel = .22, kToesFromHeel = .74, kToesHeight = .10;
// Shares of the body's height: what belongs to a foot above its sole, and how long a foot is.
constexpr double kFootHeight = .05, kShortestFoot = .09, kLongestFoot = .25;
constexpr double kMaxAnkleShift = .3;  // share of the foot's length
constexpr double kStation =
    .1;  // share of the foot's length around the balls that shows its middle

// The extents of one foot: along its direction and above the floor.
struct FootExtents {
  double heel = std::numeric_limits<double>::infinity(), tip = -heel, sole = heel;
  double left = heel, right = -heel;  // across, around the balls
};

// The vertices of the shell that belong to the lower leg and foot that end in `ankle` and `toes`.
std::vector<Eigen::Vector3d> VerticesOfFoot(const MainBody& body, const Eigen::Matrix3Xd& joints,
                                            int ankle, int toes) {
  std::vector<Eigen::Vector3d> vertices;
  const double highest = .5 * (joints(1, ankle) + joints(1, ankle - 1));
  for (Eigen::Index v = 0; v < body.shell.positions.cols(); ++v) {
    const Eigen::Vector3d vertex = body.shell.positions.col(v);
    if (vertex.y() > highest) continue;
    const int bone = FindNearestBones(HumanTemplate(), joints, vertex).bones[0];
    if (bone == ankle || bone == toes) vertices.push_back(vertex);
  }
  return vertices;
}

}  // namespace

std::array<bool, 2> PlaceFeet(const MainBody& body, Eigen::Matrix3Xd* joints) {
  std::array<bool, 2> moved = {false, false};
  const double height = body.bounds.sizes().y();
  const Eigen::Matrix3Xd before = *joints;
  for (int side = 0; side < 2; ++side) {
    const int ankle = side == 0 ? kLeftFoot : kRightFoot, toes = ankle + 1;
    Eigen::Vector3d along = before.col(toes) - before.col(ankle);
    along.y() = 0;
    if (!(along.norm() > 0)) continue;
    along.normalize();
    const Eigen::Vector3d across = Eigen::Vector3d::UnitY().cross(along);
    const std::vector<Eigen::Vector3d> vertices = VerticesOfFoot(body, before, ankle, toes);
    FootExtents foot;
    for (const Eigen::Vector3d& vertex : vertices) foot.sole = std::min(foot.sole, vertex.y());
    for (const Eigen::Vector3d& vertex : vertices) {
      if (vertex.y() > foot.sole + kFootHeight * height) continue;
      foot.heel = std::min(foot.heel, along.dot(vertex));
      foot.tip = std::max(foot.tip, along.dot(vertex));
    }
    const double length = foot.tip - foot.heel;
    if (!(length > kShortestFoot * height && length < kLongestFoot * height)) continue;
    // Across the foot, the ankle stays in the line of the lower leg. A line that meets the foot
    // near its tip is that of a body that faces the other way: its feet must not seem to fit.
    const double ankle_height = foot.sole + kAnkleHeight * length;
    const Eigen::Vector3d knee = before.col(ankle - 1),
                          shin = Eigen::Vector3d(before.col(ankle)) - knee;
    const double share = shin.y() < 0 ? (ankle_height - knee.y()) / shin.y() : 1;
    const Eigen::Vector3d in_line = knee + std::clamp(share, .5, 1.5) * shin;
    const double ankle_along = foot.heel + kAnkleFromHeel * length;
    if (std::abs(along.dot(in_line) - ankle_along) > kMaxAnkleShift * length) continue;
    const double balls = foot.heel + kToesFromHeel * length;
    for (const Eigen::Vector3d& vertex : vertices) {
      if (vertex.y() > foot.sole + kFootHeight * height ||
          std::abs(along.dot(vertex) - balls) > kStation * length) {
        continue;
      }
      foot.left = std::min(foot.left, across.dot(vertex));
      foot.right = std::max(foot.right, across.dot(vertex));
    }
    if (!(foot.left < foot.right)) continue;
    const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
    joints->col(toes) = balls * along + .5 * (foot.left + foot.right) * across +
                        (foot.sole + kToesHeight * length) * up;
    joints->col(ankle) = ankle_along * along + across.dot(in_line) * across + ankle_height * up;
    moved[side] = true;
  }
  return moved;
}

}  // namespace pleat
