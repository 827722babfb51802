// What the tests of messages share.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "pleat/base/random.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

inline const std::string kId(64, 'a');

// Through the bytes, as on the wire.
template <typename Message>
Message Reparse(const Message& message) {
  Message copy;
  EXPECT_TRUE(copy.ParseFromString(message.SerializeAsString()));
  return copy;
}

inline Pose RandomPose(Random* random, int num_joints) {
  Pose pose;
  pose.root_position << random->Normal(), random->Normal(), random->Normal();
  for (int j = 0; j < num_joints; ++j) {
    Eigen::Quaterniond q(random->Normal(), random->Normal(), random->Normal(), random->Normal());
    pose.rotations.push_back(q.normalized());
  }
  return pose;
}

inline bool SamePose(const Pose& a, const Pose& b) {
  if (a.root_position != b.root_position || a.rotations.size() != b.rotations.size()) return false;
  for (size_t j = 0; j < a.rotations.size(); ++j) {
    if (a.rotations[j].coeffs() != b.rotations[j].coeffs()) return false;
  }
  return true;
}

}  // namespace pleat
