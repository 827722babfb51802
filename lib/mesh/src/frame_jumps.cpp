#include "pleat/mesh/frame_jumps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace pleat {
namespace {

constexpr const char *kSizeJumps = "size_jumps", *kShapeJumps = "shape_jumps";  // kinds of notes

// The thresholds lie between what motion does and what jumps do. In captures and simulated cloth
// at 30 frames per second, 4 % of the edges change by a factor of more than 1.3 from one frame to
// the next at most, 1 % by 2 and .4 % by 4; at 3 frames per second 38 %, 4 % and 1.2 %. The median
// never changes by more than 3 %.
constexpr double kScale = 1.25;
constexpr EdgeChange kLargest = {.share_moderate = 0.4, .share_large = 0.1, .share_extreme = 0.03};
// A jump is also this many times what the clip does elsewhere.
constexpr double kLiveliness = 4;
// Replaces share_moderate for a single frame that the motion goes back from.
constexpr double kModerateOutAndBack = 0.15;
constexpr int kMaxEdges = 4096;
constexpr size_t kMaxGroups = 16;
constexpr size_t kMinBoundaries = 8;  // fewer do not tell what is usual

bool IsScaled(double scale) { return scale > kScale || scale < 1 / kScale; }

// Larger than the threshold and than what is usual in the clip.
bool Exceeds(double share, double threshold, double usual) {
  return share > std::max(threshold, kLiveliness * usual);
}

class JumpFinder {
 public:
  explicit JumpFinder(const MeshSequence& sequence)
      : sequence_(sequence), edges_(SampleEdges(sequence.topology(), kMaxEdges)) {}

  std::vector<FrameJump> Find() {
    if (sequence_.num_frames() < 2 || edges_.empty()) return {};
    Measure();
    GroupFrames();
    if (groups_.size() < 2) return {};
    const auto motion = std::max_element(
        groups_.begin(), groups_.end(),
        [](const auto& a, const auto& b) { return a.frames.size() < b.frames.size(); });
    std::rotate(groups_.begin(), motion, motion + 1);
    std::vector<FrameJump> jumps;
    for (size_t g = 1; g < groups_.size(); ++g) {
      const int frame = groups_[g].frames[0];
      jumps.push_back({groups_[g].frames, Compare(NearestTo(frame, groups_[0].frames), frame)});
    }
    std::ranges::sort(jumps, {}, [](const FrameJump& jump) { return jump.frames[0]; });
    return jumps;
  }

 private:
  struct Group {
    std::vector<int> frames;
  };

  std::vector<float> Lengths(int t) const { return EdgeLengths(edges_, sequence_.frame(t)); }
  EdgeChange Compare(int before, int after) const {
    return CompareEdgeLengths(Lengths(before), Lengths(after));
  }

  static int NearestTo(int frame, const std::vector<int>& frames) {
    return *std::ranges::min_element(frames, {}, [&](int t) { return std::abs(t - frame); });
  }

  // changes_[t] leads from frame t to frame t + 1.
  void Measure() {
    std::vector<float> before = Lengths(0);
    for (int t = 1; t < sequence_.num_frames(); ++t) {
      std::vector<float> after = Lengths(t);
      changes_.push_back(CompareEdgeLengths(before, after));
      before = std::move(after);
    }
    if (changes_.size() < kMinBoundaries) return;
    const auto quartile = [&](double EdgeChange::*share) {
      std::vector<double> shares;
      for (const EdgeChange& change : changes_) shares.push_back(change.*share);
      const auto at = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 4);
      std::nth_element(shares.begin(), at, shares.end());
      return *at;
    };
    usual_.share_moderate = quartile(&EdgeChange::share_moderate);
    usual_.share_large = quartile(&EdgeChange::share_large);
    usual_.share_extreme = quartile(&EdgeChange::share_extreme);
  }

  bool IsJump(const EdgeChange& change) const {
    return IsScaled(change.scale) ||
           Exceeds(change.share_moderate, kLargest.share_moderate, usual_.share_moderate) ||
           Exceeds(change.share_large, kLargest.share_large, usual_.share_large) ||
           Exceeds(change.share_extreme, kLargest.share_extreme, usual_.share_extreme);
  }

  // How much frame t differs from both frames beside it, when those are alike; else 0. Small meshes
  // show no large changes when they are shuffled.
  double OutAndBack(int t) const {
    if (t == 0 || t + 1 >= sequence_.num_frames()) return 0;
    const double least = std::min(changes_[t - 1].share_moderate, changes_[t].share_moderate);
    return Exceeds(least, kModerateOutAndBack, usual_.share_moderate) &&
                   Compare(t - 1, t + 1).share_moderate < least / kLiveliness
               ? least
               : 0;
  }

  void GroupFrames() {
    groups_.push_back(Group{std::vector<int>{0}});
    size_t current = 0;
    double last_out = 0;
    for (int t = 1; t < sequence_.num_frames(); ++t) {
      const double out = OutAndBack(t);
      if (out > 0 || last_out > 0 || IsJump(changes_[t - 1])) {
        current = GroupOf(t, std::max(out, last_out));
      }
      last_out = out;
      groups_[current].frames.push_back(t);
    }
  }

  // The group that frame t goes back to; a new one when there is none. The last group takes what
  // comes when there are too many. out: the size of a jump out or back, 0 = of another kind.
  size_t GroupOf(int t, double out) {
    for (size_t g = groups_.size(); g-- > 0;) {
      const EdgeChange change = Compare(groups_[g].frames.back(), t);
      const bool fits =
          out > 0 ? !IsScaled(change.scale) && change.share_moderate < out / 2 : !IsJump(change);
      if (fits) return g;
    }
    if (groups_.size() < kMaxGroups) groups_.push_back({});
    return groups_.size() - 1;
  }

  const MeshSequence& sequence_;
  const std::vector<Edge> edges_;
  std::vector<EdgeChange> changes_;
  EdgeChange usual_;
  std::vector<Group> groups_;
};

}  // namespace

bool FrameJump::is_scaled_only() const {
  return IsScaled(change.scale) && change.share_moderate <= kModerateOutAndBack;
}

std::vector<FrameJump> FindFrameJumps(const MeshSequence& sequence) {
  return JumpFinder(sequence).Find();
}

std::vector<InputNote> DescribeJumps(const std::vector<FrameJump>& jumps,
                                     const std::vector<std::string>& frame_names) {
  std::vector<InputNote> notes;
  for (const FrameJump& jump : jumps) {
    const bool one = jump.frames.size() == 1;
    InputNote note{.severity = NoteSeverity::kWarning,
                   .kind = jump.is_scaled_only() ? kSizeJumps : kShapeJumps,
                   .text = FrameListLabel(frame_names, jump.frames),
                   .frame = jump.frames[0]};
    if (jump.is_scaled_only()) {
      absl::StrAppendFormat(&note.text,
                            " %s %.3g times as large as the frames beside %s (edges x%.3g): "
                            "another unit? Repair or remove %s",
                            one ? "is" : "are", jump.change.scale, one ? "it" : "them",
                            jump.change.scale, one ? "it" : "them");
    } else {
      absl::StrAppendFormat(
          &note.text,
          " %s: the vertices are in another order than in the frames beside %s, or the shape is "
          "another one (%.0f %% of the edges have another length); repair or remove %s",
          one ? "jumps" : "jump", one ? "it" : "them", 100 * jump.change.share_moderate,
          one ? "it" : "them");
    }
    notes.push_back(std::move(note));
  }
  return notes;
}

bool IsJumpNote(const InputNote& note) {
  return note.kind == kSizeJumps || note.kind == kShapeJumps;
}

absl::Status RefuseFrameJumps(const MeshSequence& sequence) {
  std::string text;
  for (const InputNote& note : DescribeJumps(FindFrameJumps(sequence), {})) {
    absl::StrAppend(&text, text.empty() ? "" : "; ", note.text);
  }
  if (text.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("clip '", sequence.name(), "': ", text,
                   ", or train with --allow-jumps (option jumps=allow)"));
}

bool IsSameShape(const EdgeChange& change) {
  return change.share_moderate <= 0.25 && change.share_large <= kLargest.share_large &&
         change.share_extreme <= kLargest.share_extreme;
}

}  // namespace pleat
