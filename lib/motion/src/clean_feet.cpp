#include "pleat/motion/clean_feet.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "foot_moves.h"
#include "pleat/base/status.h"
#include "pleat/motion/two_bone_ik.h"

namespace pleat {
namespace {

constexpr double kReach = .9985;         // of a leg, that a lowered root leaves to it
constexpr double kLoweringSeconds = .2;  // over which the root sinks and rises

// By how much a hip must sink so that a leg of `length` reaches from it to `goal`.
double Lowering(const Eigen::Vector3d& hip, const Eigen::Vector3d& goal, double length) {
  const double across = std::hypot(goal.x() - hip.x(), goal.z() - hip.z());
  const double room = length * length - across * across;
  const double above = hip.y() - goal.y();
  return room > 0 ? std::max(0., above - std::sqrt(room)) : std::max(0., above);
}

// At no frame below what it was, and smooth: the largest of the neighbors, averaged over them.
std::vector<double> CoverSmoothly(const std::vector<double>& values, const ClipRange& clip,
                                  int reach) {
  const auto around = [&](const std::vector<double>& list, int t, auto join) {
    double joined = list[static_cast<size_t>(t)];
    for (int s = t - reach; s <= t + reach; ++s) {
      if (s != t)
        joined = join(joined, list[static_cast<size_t>(std::clamp(s, clip.begin, clip.end - 1))]);
    }
    return joined;
  };
  std::vector<double> largest = values, smooth = values;
  for (int t = clip.begin; t < clip.end; ++t) {
    largest[static_cast<size_t>(t)] =
        around(values, t, [](double a, double b) { return std::max(a, b); });
  }
  for (int t = clip.begin; t < clip.end; ++t) {
    smooth[static_cast<size_t>(t)] =
        around(largest, t, [](double a, double b) { return a + b; }) / (2 * reach + 1);
  }
  return smooth;
}

class FootCleaner {
 public:
  FootCleaner(const Skeleton& skeleton, const LegJoints& legs, PoseTrack::Parts parts,
              const CleanFeetOptions& options, CleanFeetSummary* summary)
      : skeleton_(skeleton),
        legs_(legs),
        parts_(std::move(parts)),
        options_(options),
        summary_(summary) {}

  void PlaceFeet(const std::array<FootContacts, 2>& contacts) {
    paths_ = FootPaths(skeleton_, legs_, parts_.poses);
    const double floor = HeightOfFeet(legs_, skeleton_, paths_, contacts);
    const auto num_frames = static_cast<int>(parts_.poses.size());
    for (size_t side = 0; side < 2; ++side) {
      const LegJoints::Leg& leg = legs_.legs[side];
      const int low = leg.toes < 0 ? leg.ankle : leg.toes;
      const FootHeights heights{floor + skeleton_.rest_position(leg.ankle).y(),
                                floor + skeleton_.rest_position(low).y()};
      Eigen::Matrix3Xd moves = Eigen::Matrix3Xd::Zero(3, num_frames);
      for (const int start : parts_.clip_starts) {
        const ClipRange clip = ClipOfFrame(parts_.clip_starts, num_frames, start);
        AddFootMoves(paths_[side], contacts[side], heights, clip, parts_.fps, options_, &moves);
      }
      summary_->max_move_m = std::max(summary_->max_move_m, moves.colwise().norm().maxCoeff());
      goals_[side] = paths_[side].ankle + moves;
    }
  }

  void LowerRoot() {
    const double length = kReach * legs_.MeanLength(skeleton_);
    const auto num_frames = static_cast<int>(parts_.poses.size());
    std::vector<double> needed(parts_.poses.size(), 0);
    for (int t = 0; t < num_frames; ++t) {
      ComputeBoneTransforms(skeleton_, parts_.poses[static_cast<size_t>(t)], {}, &transforms_);
      for (size_t side = 0; side < 2; ++side) {
        const Eigen::Vector3d hip = transforms_.joint_positions.col(legs_.legs[side].hip);
        double& most = needed[static_cast<size_t>(t)];
        most = std::max(most, Lowering(hip, goals_[side].col(t), length));
      }
      needed[static_cast<size_t>(t)] =
          std::min(needed[static_cast<size_t>(t)], options_.max_lowering * length);
    }
    const int reach = std::max(1, static_cast<int>(std::lround(kLoweringSeconds * parts_.fps)));
    for (const int start : parts_.clip_starts) {
      const ClipRange clip = ClipOfFrame(parts_.clip_starts, num_frames, start);
      const std::vector<double> smooth = CoverSmoothly(needed, clip, reach);
      for (int t = clip.begin; t < clip.end; ++t) {
        const double lowering = smooth[static_cast<size_t>(t)];
        parts_.poses[static_cast<size_t>(t)].root_position.y() -= lowering;
        summary_->max_lowering_m = std::max(summary_->max_lowering_m, lowering);
      }
    }
  }

  PoseTrack::Parts BendLegs() && {
    for (size_t t = 0; t < parts_.poses.size(); ++t) {
      ComputeBoneTransforms(skeleton_, parts_.poses[t], {}, &transforms_);
      bool reached = true;
      for (size_t side = 0; side < 2; ++side) {
        reached = BendLeg(legs_.legs[side], goals_[side].col(static_cast<Eigen::Index>(t)),
                          &parts_.poses[t]) &&
                  reached;
      }
      if (!reached) ++summary_->num_unreached_frames;
    }
    return std::move(parts_);
  }

 private:
  // The axis about which the knee bends at rest: to the left of where the foot points.
  Eigen::Vector3d RestHinge(const LegJoints::Leg& leg) const {
    const int low = leg.toes < 0 ? leg.ankle : leg.toes;
    Eigen::Vector3d heading = skeleton_.rest_position(low) - skeleton_.rest_position(leg.ankle);
    heading.y() = 0;
    const Eigen::Vector3d hinge = Eigen::Vector3d::UnitY().cross(heading);
    if (hinge.norm() > 1e-9) return hinge.normalized();
    return (skeleton_.rest_position(legs_.legs[0].hip) - skeleton_.rest_position(legs_.legs[1].hip))
        .normalized();
  }

  bool BendLeg(const LegJoints::Leg& leg, const Eigen::Vector3d& goal, Pose* pose) {
    const Eigen::Matrix3Xd& at = transforms_.joint_positions;
    const auto world = [&](int bone) { return transforms_.rotation[static_cast<size_t>(bone)]; };
    const auto set = [&](int bone, const Eigen::Matrix3d& above, const Eigen::Matrix3d& rotation) {
      Eigen::Quaterniond& local = pose->rotations[static_cast<size_t>(bone)];
      Eigen::Quaterniond turned(above.transpose() * rotation);
      turned.normalize();
      if (turned.dot(local) < 0) turned.coeffs() *= -1;
      local = turned;
    };
    if ((goal - at.col(leg.ankle)).norm() < 1e-9) return true;
    const TwoBoneTurns turns = SolveTwoBone({.begin = at.col(leg.hip),
                                             .middle = at.col(leg.knee),
                                             .end = at.col(leg.ankle),
                                             .hinge = world(leg.knee) * RestHinge(leg)},
                                            goal);
    const Eigen::Matrix3d thigh = turns.upper * world(leg.knee);
    const Eigen::Matrix3d shank = turns.lower * world(leg.ankle);
    set(leg.knee, world(leg.hip), thigh);
    set(leg.ankle, thigh, shank);
    for (const int below : skeleton_.children(leg.ankle)) set(below, shank, world(below));
    return turns.reached;
  }

  const Skeleton& skeleton_;
  const LegJoints& legs_;
  PoseTrack::Parts parts_;
  const CleanFeetOptions& options_;
  CleanFeetSummary* summary_;
  std::array<FootPath, 2> paths_;
  std::array<Eigen::Matrix3Xd, 2> goals_;  // of the ankles, 3 x T
  BoneTransforms transforms_;
};

}  // namespace

double HeightOfFeet(const LegJoints& legs, const Skeleton& skeleton,
                    const std::array<FootPath, 2>& paths,
                    const std::array<FootContacts, 2>& contacts) {
  std::vector<double> standing, all;
  for (size_t side = 0; side < 2; ++side) {
    const LegJoints::Leg& leg = legs.legs[side];
    const double ankle = skeleton.rest_position(leg.ankle).y();
    const double toes = leg.toes < 0 ? 0 : skeleton.rest_position(leg.toes).y();
    for (Eigen::Index t = 0; t < paths[side].ankle.cols(); ++t) {
      double height = paths[side].ankle(1, t) - ankle;
      if (leg.toes >= 0) height = std::min(height, paths[side].toes(1, t) - toes);
      all.push_back(height);
      if (contacts[side].AnyAt(static_cast<size_t>(t))) standing.push_back(height);
    }
  }
  if (standing.empty()) return all.empty() ? 0 : *std::ranges::min_element(all);
  const auto middle = standing.begin() + static_cast<std::ptrdiff_t>(standing.size() / 2);
  std::nth_element(standing.begin(), middle, standing.end());
  return *middle;
}

std::array<FootContacts, 2> TrackContacts(const Skeleton& skeleton, const LegJoints& legs,
                                          const PoseTrack& track) {
  const std::array<FootPath, 2> paths = FootPaths(skeleton, legs, track.poses());
  std::array<FootContacts, 2> contacts;
  for (size_t side = 0; side < 2; ++side) {
    for (const int start : track.clip_starts()) {
      const ClipRange clip = track.ClipOf(start);
      const FootPath part{paths[side].ankle.middleCols(clip.begin, clip.end - clip.begin),
                          paths[side].toes.middleCols(clip.begin, clip.end - clip.begin)};
      const FootContacts found = DetectContacts(part, track.fps());
      std::ranges::copy(found.heel, std::back_inserter(contacts[side].heel));
      std::ranges::copy(found.ball, std::back_inserter(contacts[side].ball));
    }
  }
  return contacts;
}

absl::StatusOr<PoseTrack> CleanFeet(const Skeleton& skeleton, const PoseTrack& track,
                                    const std::array<FootContacts, 2>& contacts,
                                    const CleanFeetOptions& options, CleanFeetSummary* summary) {
  assert(contacts[0].heel.size() == static_cast<size_t>(track.num_frames()));
  assert(contacts[1].heel.size() == static_cast<size_t>(track.num_frames()));
  *summary = CleanFeetSummary{};
  PLEAT_RETURN_IF_ERROR(CheckJointCount(track, skeleton.num_joints()));
  PLEAT_ASSIGN_OR_RETURN(const LegJoints legs, FindLegJoints(skeleton));
  summary->before = MeasureSliding(FootPaths(skeleton, legs, track.poses()), contacts);
  FootCleaner cleaner(skeleton, legs, track.parts(), options, summary);
  cleaner.PlaceFeet(contacts);
  cleaner.LowerRoot();
  PoseTrack::Parts cleaned = std::move(cleaner).BendLegs();
  summary->after = MeasureSliding(FootPaths(skeleton, legs, cleaned.poses), contacts);
  return PoseTrack::Create(std::move(cleaned));
}

}  // namespace pleat
