#include "pleat/motion/foot_contacts.h"

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

// The share of frames in which a point is lower than "low", so that a few wrong ones do not count.
constexpr double kLowShare = .02;
// Speeds are those over this time, which marker noise does not reach.
constexpr double kSpeedSeconds = .05;

// Turns entries of `value` into the other one where fewer than `length` of them follow each other.
// Runs at the two ends stay: their length is not known.
void FlipShortRuns(bool value, size_t length, std::vector<bool>* flags) {
  size_t begin = 0;
  while (begin < flags->size()) {
    size_t end = begin;
    while (end < flags->size() && (*flags)[end] == (*flags)[begin]) ++end;
    const bool at_end = begin == 0 || end == flags->size();
    if ((*flags)[begin] == value && end - begin < length && !at_end) {
      std::fill(flags->begin() + static_cast<std::ptrdiff_t>(begin),
                flags->begin() + static_cast<std::ptrdiff_t>(end), !value);
    }
    begin = end;
  }
}

std::vector<bool> PointContacts(const Eigen::Matrix3Xd& points, double fps,
                                const ContactOptions& options) {
  const Eigen::Index num_frames = points.cols();
  std::vector<double> heights(points.row(1).begin(), points.row(1).end());
  const auto low = static_cast<std::ptrdiff_t>(kLowShare * static_cast<double>(num_frames - 1));
  std::nth_element(heights.begin(), heights.begin() + low, heights.end());
  const double max_height = heights[static_cast<size_t>(low)] + options.max_height_m;
  const auto reach =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(kSpeedSeconds * fps / 2)));
  std::vector<bool> stands;
  for (Eigen::Index t = 0; t < num_frames; ++t) {
    const Eigen::Index first = std::max<Eigen::Index>(0, t - reach);
    const Eigen::Index last = std::min(num_frames - 1, t + reach);
    const double way = (points.col(last) - points.col(first)).norm();
    const double speed = last > first ? way * fps / static_cast<double>(last - first) : 0;
    stands.push_back(points(1, t) <= max_height && speed <= options.max_speed);
  }
  FlipShortRuns(false, static_cast<size_t>(std::ceil(options.max_gap_seconds * fps)), &stands);
  FlipShortRuns(true, static_cast<size_t>(std::ceil(options.min_seconds * fps)), &stands);
  return stands;
}

void AddPoint(const Eigen::Matrix3Xd& points, const std::vector<bool>& stands,
              FootSliding* sliding) {
  for (size_t t = 1; t < stands.size(); ++t) {
    if (!stands[t] || !stands[t - 1]) continue;
    const auto frame = static_cast<Eigen::Index>(t);
    const Eigen::Vector3d step = points.col(frame) - points.col(frame - 1);
    const double way_mm = 1000 * std::hypot(step.x(), step.z());
    sliding->mean_mm += way_mm;  // a sum until all are there
    sliding->max_mm = std::max(sliding->max_mm, way_mm);
    ++sliding->num_frames;
  }
}

}  // namespace

FootContacts DetectContacts(const FootPath& path, double fps, const ContactOptions& options) {
  FootContacts contacts;
  if (path.ankle.cols() == 0) return contacts;
  contacts.heel = PointContacts(path.ankle, fps, options);
  contacts.ball = PointContacts(path.toes, fps, options);
  return contacts;
}

FootSliding MeasureSliding(const std::array<FootPath, 2>& paths,
                           const std::array<FootContacts, 2>& contacts) {
  FootSliding sliding;
  for (size_t side = 0; side < 2; ++side) {
    // The ball where it stands, since feet roll over it, and the heel where it stands alone.
    std::vector<bool> heel_alone = contacts[side].heel;
    for (size_t t = 0; t < heel_alone.size(); ++t) {
      heel_alone[t] = heel_alone[t] && !contacts[side].ball[t];
    }
    AddPoint(paths[side].toes, contacts[side].ball, &sliding);
    AddPoint(paths[side].ankle, heel_alone, &sliding);
  }
  if (sliding.num_frames > 0) sliding.mean_mm /= sliding.num_frames;
  return sliding;
}

}  // namespace pleat
