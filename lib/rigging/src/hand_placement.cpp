#include "hand_placement.h"

#include <algorithm>

#include "pleat/rigging/bone_visibility.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr double kHandShare = .77;      // share of the way from the shoulder to the tip
constexpr double kElbowShare = .5;      // share of the way to the hand, as in the template
constexpr double kMaxTipShare = .35;    // share of the arm; beyond it, it touches something
constexpr double kTipRadius = .05;      // share of the body's size, around the forearm's axis
constexpr double kMinForearmLeft = .5;  // share of the forearm as it was found

// Returns how far the surface that is nearest to the forearm reaches beyond its hand.
double ReachBeyondHand(const MainBody& body, double body_size, const Eigen::Matrix3Xd& joints,
                       int elbow, int hand) {
  const Eigen::Vector3d direction = (joints.col(hand) - joints.col(elbow)).normalized();
  double reach = 0;
  for (Eigen::Index v = 0; v < body.shell.positions.cols(); ++v) {
    const Eigen::Vector3d point = body.shell.positions.col(v);
    const Eigen::Vector3d offset = point - joints.col(hand);
    const double along = offset.dot(direction);
    if (along <= reach || (offset - along * direction).norm() > kTipRadius * body_size) continue;
    const NearestBones nearest = FindNearestBones(HumanTemplate(), joints, point);
    if (std::ranges::find(nearest.bones, hand) != nearest.bones.end()) reach = along;
  }
  return reach;
}

}  // namespace

void PlaceHands(const MainBody& body, double body_size, Eigen::Matrix3Xd* joints) {
  for (const int shoulder : {kLeftUpperArm, kRightUpperArm}) {
    const int elbow = shoulder + 1, hand = shoulder + 2;
    const Eigen::Vector3d upper = joints->col(elbow) - joints->col(shoulder);
    const Eigen::Vector3d fore = joints->col(hand) - joints->col(elbow);
    const double reach = ReachBeyondHand(body, body_size, *joints, elbow, hand);
    const double arm = upper.norm() + fore.norm() + reach;
    const double fore_length =
        std::max(kHandShare * arm - upper.norm(), kMinForearmLeft * fore.norm());
    if (reach > kMaxTipShare * arm || !(fore_length < fore.norm())) continue;
    joints->col(hand) = joints->col(elbow) + fore_length / fore.norm() * fore;
    // The elbow stays on the line of the arm as it was found, which may bend there: it slides along
    // the upper arm or into the forearm.
    const double to_elbow = kElbowShare * (upper.norm() + fore_length);
    if (to_elbow < upper.norm()) {
      joints->col(elbow) = joints->col(shoulder) + to_elbow / upper.norm() * upper;
    } else {
      joints->col(elbow) += (to_elbow - upper.norm()) / fore.norm() * fore;
    }
  }
}

}  // namespace pleat
