// Frames that do not belong to the motion around them: another unit, another order of vertices,
// another mesh. Found by the lengths of the edges, which motion of a body hardly changes from one
// frame to the next, whatever its speed.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/mesh/edge_lengths.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct FrameJump {
  std::vector<int> frames;  // ascending
  EdgeChange change;        // against the nearest frame that does not jump

  // Only the size differs; else the vertices are shuffled or the shape is another one.
  bool is_scaled_only() const;
};

// The jumps of a sequence. Neighboring frames without a jump between them belong together, and so
// do frames that a jump leads back to; the largest group is the motion, and each other group is a
// jump. Costs some thousand edge lengths per frame.
std::vector<FrameJump> FindFrameJumps(const MeshSequence& sequence);

// A warning for each jump. frame_names: see InputReport.
std::vector<InputNote> DescribeJumps(const std::vector<FrameJump>& jumps,
                                     const std::vector<std::string>& frame_names);

// Says whether a note is one of those warnings.
bool IsJumpNote(const InputNote& note);

// kFailedPrecondition names the frames that jump; what training refuses unless it is told to take
// them.
absl::Status RefuseFrameJumps(const MeshSequence& sequence);

// The mesh whose file lies beside a point cache is the mesh of its frame 0: vertex by vertex, up to
// its pose and its unit. False when the vertices are in another order or it is another object.
bool IsSameShape(const EdgeChange& change);

}  // namespace pleat
