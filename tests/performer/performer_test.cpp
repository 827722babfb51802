#include "pleat/performer/performer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "pleat/mesh/bounds.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

PerformerOptions SmallOptions() {
  PerformerOptions options;
  options.num_vertices = 1500;
  options.num_frames = 90;
  return options;
}

const Performer& SmallPerformer() {
  static const Performer performer = *GeneratePerformer(SmallOptions());
  return performer;
}

// Skinned truth of frame t, 3 x V.
Eigen::Matrix3Xd SkinnedTruth(const Performer& performer, int t) {
  BoneTransforms bones;
  ComputeBoneTransforms(performer.truth.rig.skeleton, performer.truth.track.pose(t), {}, &bones);
  Eigen::Matrix3Xd positions;
  SkinVertices(performer.truth.rig.weights, performer.truth.rig.rest_positions, bones, &positions);
  return positions;
}

double SignedVolume(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xi& triangles) {
  double volume = 0;
  for (int f = 0; f < triangles.cols(); ++f) {
    const Eigen::Vector3d a = positions.col(triangles(0, f));
    const Eigen::Vector3d b = positions.col(triangles(1, f));
    volume += a.dot(b.cross(Eigen::Vector3d(positions.col(triangles(2, f))))) / 6;
  }
  return volume;
}

void ExpectClosedSphere(const Topology& topology) {
  std::map<std::pair<int, int>, int> directed;
  std::set<int> used;
  const Eigen::Matrix3Xi& triangles = topology.triangles();
  std::vector<int> parent(topology.num_vertices());
  for (int v = 0; v < topology.num_vertices(); ++v) parent[v] = v;
  const auto find = [&](int v) {
    while (parent[v] != v) v = parent[v];
    return v;
  };
  for (int f = 0; f < triangles.cols(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const int a = triangles(c, f), b = triangles((c + 1) % 3, f);
      ++directed[{a, b}];
      used.insert(a);
      parent[find(a)] = find(b);
    }
  }
  for (const auto& [edge, count] : directed) {
    ASSERT_EQ(count, 1) << edge.first << "-" << edge.second;
    ASSERT_TRUE(directed.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(static_cast<int>(used.size()), topology.num_vertices());  // no isolated vertex
  int num_components = 0;
  for (int v = 0; v < topology.num_vertices(); ++v) num_components += find(v) == v;
  EXPECT_EQ(num_components, 1);
  EXPECT_EQ(
      topology.num_vertices() - static_cast<int>(directed.size()) / 2 + topology.num_triangles(),
      2);  // genus 0
}

TEST(Performer, IsAClosedOutwardSphereAtAnyResolution) {
  for (int wanted : {800, 2500, 12000}) {
    for (uint64_t character_seed : {1, 7}) {
      PerformerOptions options;
      options.num_vertices = wanted;
      options.num_frames = 2;
      options.character_seed = character_seed;
      PLEAT_ASSERT_OK_AND_ASSIGN(const Performer performer, GeneratePerformer(options));
      ExpectClosedSphere(performer.sequence.topology());
      EXPECT_NEAR(performer.sequence.num_vertices(), wanted, .05 * wanted);
      const double volume = SignedVolume(performer.sequence.FrameAsDouble(0),
                                         performer.sequence.topology().triangles());
      EXPECT_GT(volume, .03);  // cubic meters
      EXPECT_LT(volume, .15);
    }
  }
}

TEST(Performer, TrianglesAreWellShaped) {
  const Eigen::Matrix3Xd rest = SmallPerformer().sequence.FrameAsDouble(0);
  const Eigen::Matrix3Xi& triangles = SmallPerformer().sequence.topology().triangles();
  double smallest = 180;
  for (int f = 0; f < triangles.cols(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d corner = rest.col(triangles(c, f));
      const Eigen::Vector3d u = rest.col(triangles((c + 1) % 3, f)) - corner;
      const Eigen::Vector3d w = rest.col(triangles((c + 2) % 3, f)) - corner;
      smallest = std::min(smallest, std::atan2(u.cross(w).norm(), u.dot(w)) * 180 / M_PI);
    }
  }
  EXPECT_GT(smallest, 15);
}

TEST(Performer, StandsOnTheFloorAtTheWantedHeight) {
  const Eigen::AlignedBox3d box = ComputeBounds(SmallPerformer().sequence.FrameAsDouble(0));
  EXPECT_NEAR(box.min().y(), 0, .01);
  EXPECT_NEAR(box.sizes().y(), 1.7, .05);
  // Feet stay on the floor while dancing.
  for (int t = 0; t < SmallPerformer().sequence.num_frames(); t += 7) {
    EXPECT_NEAR(ComputeBounds(SmallPerformer().sequence.FrameAsDouble(t)).min().y(), 0, .12) << t;
  }
}

TEST(Performer, HasTheTemplatesSkeletonInsideTheBody) {
  const Skeleton& skeleton = SmallPerformer().truth.rig.skeleton;
  ASSERT_EQ(skeleton.num_joints(), kNumHumanJoints);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_EQ(skeleton.joint(j).name, HumanTemplate().joint(j).name);
    EXPECT_EQ(skeleton.parent(j), HumanTemplate().parent(j));
    EXPECT_LT((skeleton.rest_position(j) / 1.7 - HumanTemplate().rest_position(j)).norm(), .02);
  }
}

TEST(Performer, FrameZeroIsTheRestShape) {
  const Performer& performer = SmallPerformer();
  EXPECT_TRUE(performer.sequence.FrameAsDouble(0) == performer.truth.rig.rest_positions);
  for (const Eigen::Quaterniond& q : performer.truth.track.pose(0).rotations) {
    EXPECT_DOUBLE_EQ(q.w(), 1);
  }
  EXPECT_LT((SkinnedTruth(performer, 0) - performer.truth.rig.rest_positions).norm(), 1e-4);
}

TEST(Performer, BodyIsExactlySkinnedAndTheSkirtIsNot) {
  for (double yaw_degrees : {0., 130.}) {
    PerformerOptions options = SmallOptions();
    options.yaw_degrees = yaw_degrees;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Performer performer, GeneratePerformer(options));
    double largest_detail = 0;
    for (int t = 0; t < performer.sequence.num_frames(); ++t) {
      const Eigen::Matrix3Xd difference =
          performer.sequence.FrameAsDouble(t) - SkinnedTruth(performer, t);
      for (int v = 0; v < difference.cols(); ++v) {
        const double detail = difference.col(v).norm();
        if (performer.truth.is_skirt[v] != 0) {
          largest_detail = std::max(largest_detail, detail);
        } else {
          ASSERT_LT(detail, 2e-6) << "frame " << t << ", vertex " << v;
        }
      }
    }
    EXPECT_GT(largest_detail, .05);
    EXPECT_LT(largest_detail, .40);
  }
}

TEST(Performer, SkirtMovesSmoothlyInTime) {
  const MeshSequence& sequence = SmallPerformer().sequence;
  double fastest = 0;  // meters per frame
  for (int t = 1; t < sequence.num_frames(); ++t) {
    fastest = std::max<double>(
        fastest, (sequence.frame(t) - sequence.frame(t - 1)).colwise().norm().maxCoeff());
  }
  EXPECT_LT(fastest, .35);
}

TEST(Performer, DetailBeginsAtRestAndBuildsUp) {
  const Performer& performer = SmallPerformer();
  const auto mean_detail = [&](int t) {
    return (performer.sequence.FrameAsDouble(t) - SkinnedTruth(performer, t))
        .colwise()
        .norm()
        .mean();
  };
  EXPECT_LT(mean_detail(0), 1e-6);
  EXPECT_LT(mean_detail(1), .002);
  EXPECT_GT(mean_detail(45), .002);
}

TEST(Performer, SameOptionsGiveTheSameSequenceAndSeedsDiffer) {
  PerformerOptions options = SmallOptions();
  options.num_frames = 40;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer first, GeneratePerformer(options));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer again, GeneratePerformer(options));
  EXPECT_TRUE(first.sequence.topology() == again.sequence.topology());
  for (int t = 0; t < 40; ++t) EXPECT_TRUE(first.sequence.frame(t) == again.sequence.frame(t));

  options.seed = 2;  // other motion of the same mesh
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer other, GeneratePerformer(options));
  EXPECT_TRUE(first.sequence.topology() == other.sequence.topology());
  EXPECT_TRUE(first.sequence.frame(0) == other.sequence.frame(0));
  EXPECT_GT((first.sequence.frame(39) - other.sequence.frame(39)).colwise().norm().mean(), .02);

  options.character_seed = 2;  // another character
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer stranger, GeneratePerformer(options));
  EXPECT_FALSE(first.sequence.topology() == stranger.sequence.topology());
}

TEST(Performer, LongerSequencesBeginWithTheShorterOnes) {
  PerformerOptions options = SmallOptions();
  options.num_frames = 20;
  options.style = PerformerStyle::kWalk;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer brief, GeneratePerformer(options));
  options.num_frames = 45;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer longer, GeneratePerformer(options));
  EXPECT_EQ(brief.sequence.num_frames(), 20);
  EXPECT_EQ(longer.sequence.num_frames(), 45);
  EXPECT_EQ(longer.truth.track.num_frames(), 45);
  EXPECT_TRUE(brief.sequence.frame(19) == longer.sequence.frame(19));
}

TEST(Performer, WalkTravelsForward) {
  PerformerOptions options = SmallOptions();
  options.style = PerformerStyle::kWalk;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer performer, GeneratePerformer(options));
  const PoseTrack& track = performer.truth.track;
  double along = 0;
  for (int t = 31; t < track.num_frames(); ++t) {
    const Eigen::Vector3d step = track.pose(t).root_position - track.pose(t - 1).root_position;
    along += step.dot(track.pose(t).rotations[0] * Eigen::Vector3d::UnitZ());
  }
  const double meters_per_second = along / (track.num_frames() - 31) * track.fps();
  EXPECT_GT(meters_per_second, .5);
  EXPECT_LT(meters_per_second, 2.0);
}

TEST(Performer, StandingFeetDoNotSlide) {
  for (PerformerStyle style : {PerformerStyle::kWalk, PerformerStyle::kDance}) {
    PerformerOptions options = SmallOptions();
    options.style = style;
    options.num_frames = 120;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Performer performer, GeneratePerformer(options));
    BoneTransforms bones;
    Eigen::Matrix3Xd previous;
    int num_still = 0;
    for (int t = 40; t < 120; ++t) {
      ComputeBoneTransforms(performer.truth.rig.skeleton, performer.truth.track.pose(t), {},
                            &bones);
      if (t > 40) {  // at least one foot stands, except in a jump
        double slowest = 1;
        for (int j : {kLeftToes, kRightToes}) {
          slowest = std::min(slowest, (bones.joint_positions.col(j) - previous.col(j)).norm());
        }
        num_still += slowest < .006;
      }
      previous = bones.joint_positions;
    }
    EXPECT_GT(num_still, 60);
  }
}

TEST(Performer, HeightAndFrameRateAreHonored) {
  PerformerOptions options = SmallOptions();
  options.num_frames = 5;
  options.height_m = 1.2;
  options.frame_rate = {60, 1};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer performer, GeneratePerformer(options));
  EXPECT_NEAR(ComputeBounds(performer.sequence.FrameAsDouble(0)).sizes().y(), 1.2, .04);
  EXPECT_EQ(performer.sequence.frame_rate(), (FrameRate{60, 1}));
  EXPECT_DOUBLE_EQ(performer.truth.track.fps(), 60);
}

TEST(Performer, RefusesOptionsOutOfRange) {
  PerformerOptions options;
  options.num_frames = 0;
  EXPECT_THAT(GeneratePerformer(options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("num_frames")));
  options = {};
  options.num_vertices = 3;
  EXPECT_THAT(GeneratePerformer(options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("num_vertices")));
  options = {};
  options.height_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(GeneratePerformer(options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("height_m")));
  options = {};
  options.frame_rate = {30, 0};
  EXPECT_THAT(GeneratePerformer(options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("frame_rate")));
}

TEST(Performer, StopsWhenCancelledAndReportsRisingProgress) {
  std::atomic<int> num_checks = 0;  // asked from any thread
  const Progress cancelled([](const ProgressUpdate&) {}, [&] { return ++num_checks > 5; });
  EXPECT_THAT(GeneratePerformer(SmallOptions(), cancelled),
              HasStatus(absl::StatusCode::kCancelled, ::testing::_));

  std::vector<double> fractions;
  const Progress watched(
      [&](const ProgressUpdate& update) { fractions.push_back(update.fraction); },
      [] { return false; });
  PerformerOptions options = SmallOptions();
  options.num_frames = 3;
  ASSERT_THAT(GeneratePerformer(options, watched), IsOk());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_DOUBLE_EQ(fractions.back(), 1);
}

TEST(Performer, TheSkirtIsWhereSkirtsAre) {
  const Performer& performer = SmallPerformer();
  const Eigen::Matrix3Xd& rest = performer.truth.rig.rest_positions;
  int num_skirt = 0;
  for (int v = 0; v < rest.cols(); ++v) {
    ASSERT_LE(performer.truth.is_skirt[v], 1);
    if (performer.truth.is_skirt[v] == 0) continue;
    ++num_skirt;
    EXPECT_GT(rest(1, v), .25 * 1.7) << "not below the knees";
    EXPECT_LT(rest(1, v), .65 * 1.7) << "not above the waist";
  }
  EXPECT_GT(num_skirt, .1 * static_cast<double>(rest.cols()));
  EXPECT_LT(num_skirt, .6 * static_cast<double>(rest.cols()));
}

TEST(Performer, StandsAtFirstWithTheArmsAwayFromTheBody) {
  const Performer& performer = SmallPerformer();
  const Skeleton& skeleton = performer.truth.rig.skeleton;
  for (const int hand : {kLeftHand, kRightHand}) {
    const int shoulder = hand == kLeftHand ? kLeftUpperArm : kRightUpperArm;
    const Eigen::Vector3d arm = skeleton.rest_position(hand) - skeleton.rest_position(shoulder);
    EXPECT_GT(std::abs(arm.x()), .15) << "meters to the side";
    EXPECT_GT(std::abs(skeleton.rest_position(hand).x()),
              std::abs(skeleton.rest_position(shoulder).x()));
  }
  EXPECT_GT(skeleton.rest_position(kLeftHand).x(), 0) << "facing +z, the left is at +x";
}

}  // namespace
}  // namespace pleat
