// Kovar, Schreiner and Gleicher, Footskate Cleanup for Motion Capture Editing, SCA 2002, place the
// feet in the same way: a constant place for each contact, and blends between.
#include "foot_moves.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "blending.h"

namespace pleat {
namespace {

struct Run {
  int begin = 0, end = 0;
};

std::vector<Run> ContactRuns(const FootContacts& contacts, const ClipRange& clip) {
  std::vector<Run> runs;
  for (int t = clip.begin; t < clip.end; ++t) {
    if (!contacts.AnyAt(static_cast<size_t>(t))) continue;
    if (runs.empty() || runs.back().end != t) runs.push_back({t, t});
    runs.back().end = t + 1;
  }
  return runs;
}

class MoveMaker {
 public:
  MoveMaker(const FootPath& path, const FootContacts& contacts, const FootHeights& heights,
            const CleanFeetOptions& options, Eigen::Matrix3Xd* moves)
      : path_(path), contacts_(contacts), heights_(heights), options_(options), moves_(*moves) {}

  // Holds the standing point. Where the foot rolls from the heel to the ball, the ball goes on from
  // where it is then. The whole contact is placed so that its moves are zero on average.
  void Hold(const Run& run) {
    Eigen::Vector3d pin = Standing(run.begin, IsBall(run.begin)), mean = Eigen::Vector3d::Zero();
    bool is_ball = IsBall(run.begin);
    for (int t = run.begin; t < run.end; ++t) {
      if (IsBall(t) != is_ball) {
        is_ball = IsBall(t);
        pin = Standing(t - 1, is_ball) + moves_.col(t - 1);
      }
      moves_.col(t) = pin - Standing(t, is_ball);
      mean += moves_.col(t) / (run.end - run.begin);
    }
    for (int t = run.begin; t < run.end; ++t) {
      moves_.col(t).x() -= mean.x();
      moves_.col(t).z() -= mean.z();
      moves_(1, t) = Lift(t);
    }
  }

  // From the moves of frame `from` to those of frame `to`, where the foot is in the air.
  void Blend(int from, int to) {
    for (int t = from + 1; t < to; ++t) {
      const double u = SmoothStep(static_cast<double>(t - from) / (to - from));
      moves_.col(t) = (1 - u) * moves_.col(from) + u * moves_.col(to);
    }
  }

  // No point of the foot is below where it stands.
  void StayAbove(int t) {
    const double lowest =
        std::min(path_.toes(1, t) - heights_.toes, path_.ankle(1, t) - heights_.ankle);
    moves_(1, t) = std::max(moves_(1, t), -lowest);
  }

 private:
  bool IsBall(int t) const { return contacts_.ball[static_cast<size_t>(t)]; }
  Eigen::Vector3d Standing(int t, bool is_ball) const {
    return is_ball ? path_.toes.col(t) : path_.ankle.col(t);
  }
  // To the floor, of a foot that stands near it.
  double Lift(int t) const {
    const double lift =
        IsBall(t) ? heights_.toes - path_.toes(1, t) : heights_.ankle - path_.ankle(1, t);
    return std::abs(lift) <= options_.max_height_m ? lift : 0;
  }

  const FootPath& path_;
  const FootContacts& contacts_;
  const FootHeights& heights_;
  const CleanFeetOptions& options_;
  Eigen::Matrix3Xd& moves_;
};

}  // namespace

void AddFootMoves(const FootPath& path, const FootContacts& contacts, const FootHeights& heights,
                  const ClipRange& clip, double fps, const CleanFeetOptions& options,
                  Eigen::Matrix3Xd* moves) {
  MoveMaker maker(path, contacts, heights, options, moves);
  const std::vector<Run> runs = ContactRuns(contacts, clip);
  const int blend = std::max(1, static_cast<int>(std::lround(options.blend_seconds * fps)));
  for (const Run& run : runs) maker.Hold(run);
  for (size_t i = 0; i < runs.size(); ++i) {
    if (i == 0) maker.Blend(std::max(clip.begin, runs[0].begin - blend), runs[0].begin);
    const int next = i + 1 < runs.size() ? runs[i + 1].begin : clip.end + 2 * blend;
    if (next - runs[i].end < 2 * blend) {
      maker.Blend(runs[i].end - 1, next);
      continue;
    }
    maker.Blend(runs[i].end - 1, std::min(clip.end - 1, runs[i].end - 1 + blend));
    if (i + 1 < runs.size()) maker.Blend(next - blend, next);
  }
  for (int t = clip.begin; t < clip.end; ++t) maker.StayAbove(t);
}

}  // namespace pleat
