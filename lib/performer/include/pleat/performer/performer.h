// A performer is a made-up animated character whose skeleton, weights and poses are known. Tests
// and measurements use it where a capture has no truth to compare with.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

enum class PerformerStyle { kWalk, kDance };

struct PerformerOptions {
  // The motion. Different seeds give different motion of the same kind, so that one clip can train
  // a character and another can test it on the same mesh.
  uint64_t seed = 1;
  // The character (proportions, skirt): two performers with equal character_seed, num_vertices,
  // height_m and yaw_degrees have the same mesh and the same weights.
  uint64_t character_seed = 1;
  PerformerStyle style = PerformerStyle::kDance;
  int num_frames = 200;     // 1 .. 100000
  int num_vertices = 6000;  // wanted, 500 .. 100000; the mesh comes within about 5 % of it
  FrameRate frame_rate{};   // 5 .. 240 frames per second
  double height_m = 1.7;    // 0.1 .. 10
  double yaw_degrees = 0;   // facing in frame 0: 0 = +z, 90 = +x
};

// The truth, which a method that sees only the sequence has to find again.
struct PerformerTruth {
  Rig rig;          // human template (same joints and names), true weights, frame 0 as rest shape
  PoseTrack track;  // pose 0 is the rest pose
  // V: 1 where the skirt's own dynamics may move the vertex. All other vertices are in every frame
  // exactly the linear blend skinning of `rig` by `track` (to float32).
  std::vector<uint8_t> is_skirt;
};

struct Performer {
  MeshSequence sequence;  // closed surface of genus 0, triangles oriented outward, meters
  PerformerTruth truth;
};

// Makes a person in a skirt: an implicit body polygonized and remeshed to the wanted resolution, a
// procedural motion, and a skirt whose swing is integrated as cloth (XPBD) that collides with the
// legs. Frame 0 stands still with the arms away from the body. The result depends on the options
// alone. The error is kInvalidArgument and names an option out of range, kInternal when no closed
// surface comes out, and kCancelled.
absl::StatusOr<Performer> GeneratePerformer(const PerformerOptions& options,
                                            const Progress& progress = {});

}  // namespace pleat
