// When a foot stands on the floor, and how far it slides while it does
// (docs/method/motion.md#feet).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace pleat {

// The way of a foot: 3 x T, meters, Y up.
struct FootPath {
  Eigen::Matrix3Xd ankle, toes;
};

struct ContactOptions {
  double max_speed = .3;         // meters per second, of a point that stands
  double max_height_m = .05;     // above where the point is when it is low
  double min_seconds = .08;      // of a contact; shorter ones are not
  double max_gap_seconds = .05;  // between contacts that are one
};

// T entries each: whether the heel (below the ankle) and the ball of the foot (at the toes) stand.
struct FootContacts {
  std::vector<bool> heel, ball;

  bool AnyAt(size_t frame) const { return heel[frame] || ball[frame]; }
};
FootContacts DetectContacts(const FootPath& path, double fps, const ContactOptions& options = {});

struct FootSliding {
  int num_frames = 0;  // of contact, in which a point stands as it did in the frame before
  double mean_mm = 0;  // horizontal way of the standing point per frame
  double max_mm = 0;
};
// Measures both feet. The contacts may be those of another motion of the same length.
FootSliding MeasureSliding(const std::array<FootPath, 2>& paths,
                           const std::array<FootContacts, 2>& contacts);

}  // namespace pleat
