// What feet and knees say about where a character faces, independent of the embedding's search
// (docs/method/rig.md#facing).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/body_volume.h"

namespace pleat {

// A placed human skeleton in one frame of a sequence.
struct FacingHypothesis {
  int frame = 0;
  Eigen::Matrix3Xd joints;                             // 3 x 18, template order, meters
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();  // where the character is said to face
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();       // unit, perpendicular to `forward`
};

// Evidence for a hypothesis. Positive numbers speak for it, negative ones for the opposite facing;
// each is in -1..1, and 0 where there is nothing to see. The search's residual decides between
// front and back by the direction of two short bones alone; a foot is longer before the ankle than
// behind it, and a knee bends one way only.
struct FacingEvidence {
  double feet = 0;   // shape: how far the feet reach before the line of the lower leg
  double knees = 0;  // motion: the side to which the knees bend, over the frames of the sequence

  // The sum of both. Below 0 the opposite facing is more likely.
  double total() const { return feet + 1.5 * knees; }
};

struct FacingEvidenceOptions {
  int max_frames = 24;            // evenly spaced ones are looked at
  double sure_foot_offset = .02;  // share of the body's height that counts as 1
  double sure_knee_bend = .15;    // mean sine of the bend that counts as 1
};

// Weighs feet and knees. `shell` is that of the hypothesis' frame, in meters. The hypothesis'
// skeleton need not be exact: vertices go to their nearest bone, and thighs and lower legs are
// followed through the frames by rigid fits.
FacingEvidence WeighFacing(const MeshSequence& sequence, const BodyShell& shell,
                           const FacingHypothesis& hypothesis,
                           const FacingEvidenceOptions& options = {});

}  // namespace pleat
