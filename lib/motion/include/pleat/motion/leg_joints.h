// The legs of a character, for its feet.
#pragma once

#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/motion/foot_contacts.h"
#include "pleat/skeleton/pose.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct LegJoints {
  struct Leg {
    int hip = -1, knee = -1, ankle = -1;  // joints of the skeleton
    int toes = -1;                        // -1 where there are none
  };
  std::array<Leg, 2> legs;  // left, right

  // The mean length from hip to ankle along the bones, meters.
  double MeanLength(const Skeleton& skeleton) const;
};

// kInvalidArgument when the skeleton has no joints that are known as legs, or where they are not
// the two bones from the hip to the knee and on to the ankle.
absl::StatusOr<LegJoints> FindLegJoints(const Skeleton& skeleton);

// The ways of both feet. Without toes the ankle takes their place.
std::array<FootPath, 2> FootPaths(const Skeleton& skeleton, const LegJoints& legs,
                                  const std::vector<Pose>& poses);

}  // namespace pleat
