// Poses may come far more often than the history looks back: an engine shows a thousand frames per
// second, and the history of a model spans a quarter of one. So of the poses of every sixteenth of
// an interval only the newest is kept, which bounds the memory and costs no precision that a
// velocity over a whole interval could show.
#include "pleat/skeleton/recent_motion.h"

#include <cassert>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr size_t kEntriesPerInterval = 16;

}  // namespace

RecentMotion::RecentMotion(int num_joints, double interval_seconds, int depth)
    : interval_seconds_(interval_seconds),
      // Two more: the newest one, and the one beyond the oldest moment that is looked at.
      entries_(kEntriesPerInterval * static_cast<size_t>(depth - 1) + 3),
      between_(static_cast<size_t>(depth)) {
  assert(interval_seconds > 0 && depth >= 1);
  for (Entry& entry : entries_) entry.pose.rotations.resize(static_cast<size_t>(num_joints));
  for (Pose& pose : between_) pose.rotations.resize(static_cast<size_t>(num_joints));
}

absl::Status RecentMotion::Add(double seconds, const Pose& pose) {
  if (!std::isfinite(seconds)) {
    return absl::InvalidArgumentError("the time of the pose is not finite");
  }
  if (count_ > 0 && !(seconds > Past(0).seconds)) {
    return absl::InvalidArgumentError(absl::StrCat("the pose is at ", seconds,
                                                   " s, the one before at ", Past(0).seconds,
                                                   " s; restart the motion after a cut"));
  }
  // Entries are a step apart, except that the newest one may be nearer to the one before it.
  const double step = interval_seconds_ / kEntriesPerInterval;
  if (count_ < 2 || Past(0).seconds - Past(1).seconds >= step) {
    newest_ = (newest_ + 1) % entries_.size();
    if (count_ < entries_.size()) ++count_;
  }
  entries_[newest_].seconds = seconds;
  entries_[newest_].pose.root_position = pose.root_position;
  entries_[newest_].pose.rotations.assign(pose.rotations.begin(), pose.rotations.end());
  return absl::OkStatus();
}

void RecentMotion::History(std::vector<const Pose*>* poses) {
  assert(!empty());
  poses->resize(between_.size());
  for (size_t h = 0; h < between_.size(); ++h) {
    (*poses)[h] = At(Past(0).seconds - static_cast<double>(h) * interval_seconds_, &between_[h]);
  }
}

const Pose* RecentMotion::At(double seconds, Pose* between) const {
  const double close = 1e-6 * interval_seconds_;  // then it is the very pose, without rounding
  for (size_t age = 0; age < count_; ++age) {
    const Entry& entry = Past(age);
    if (entry.seconds > seconds + close) continue;
    if (entry.seconds > seconds - close || age == 0) return &entry.pose;
    const Entry& later = Past(age - 1);
    InterpolatePoses(entry.pose, later.pose,
                     (seconds - entry.seconds) / (later.seconds - entry.seconds), between);
    return between;
  }
  return &Past(count_ - 1).pose;  // older than all
}

}  // namespace pleat
