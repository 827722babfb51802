// The first part of a BVH file: its joints and their channels.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "text_words.h"

namespace pleat {

struct BvhChannel {
  int joint = 0;
  bool is_rotation = false;
  int axis = 0;  // 0 = x
};

struct BvhHierarchy {
  std::vector<ClipJoint> joints;     // ends have the name of the joint above and "_end"
  std::vector<BvhChannel> channels;  // in the order of the values of a frame
};

// Reads up to and with the word MOTION.
absl::StatusOr<BvhHierarchy> ReadBvhHierarchy(TextWords* words);

}  // namespace pleat
