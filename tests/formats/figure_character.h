// The small figure as a character that is written for other programs.
#pragma once

#include "pleat/formats/character_file.h"
#include "support/skinned_figure.h"

namespace pleat {

// A figure that moves for so many frames; with 0 it rests. Its 18 joints branch at the hips and the
// chest.
inline CharacterFile FigureCharacter(int num_frames) {
  const SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 2, .num_sides = 3});
  CharacterFile character;
  character.name = "figure";
  character.topology = figure.topology;
  character.rig = figure.rig;
  character.frame_rate = {30000, 1001};
  if (num_frames > 0) {
    PoseTrack::Parts parts = MakeSmoothPoses(figure.rig.skeleton, num_frames, 3, .9).parts();
    parts.fps = character.frame_rate.fps();
    character.track = PoseTrack::FromValid(std::move(parts));
  }
  return character;
}

// The largest difference of two tracks: of root positions in meters, and of rotations in radians.
inline double TrackDifference(const PoseTrack& a, const PoseTrack& b) {
  if (a.num_frames() != b.num_frames() || a.num_joints() != b.num_joints()) return 1e9;
  double largest = 0;
  for (int t = 0; t < a.num_frames(); ++t) {
    largest = std::max(largest, (a.pose(t).root_position - b.pose(t).root_position).norm());
    for (int j = 0; j < a.num_joints(); ++j) {
      const auto bone = static_cast<size_t>(j);
      largest =
          std::max(largest, a.pose(t).rotations[bone].angularDistance(b.pose(t).rotations[bone]));
    }
  }
  return largest;
}

}  // namespace pleat
