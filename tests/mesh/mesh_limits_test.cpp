#include "pleat/mesh/mesh_limits.h"

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(MeshLimitsTest, NamesTheFirstCountAboveItsLimit) {
  const MeshLimits limits = {.max_vertices = 10, .max_faces = 20, .max_frames = 3};
  const MeshCounts largest = {.num_vertices = 10, .num_faces = 20, .num_frames = 3};
  EXPECT_THAT(CheckCounts(largest, limits), IsOk());
  EXPECT_THAT(CheckCounts({.num_vertices = 11}, limits),
              HasStatus(absl::StatusCode::kResourceExhausted,
                        "11 vertices are over the limit of 10 vertices"));
  EXPECT_FALSE(CheckCounts({.num_vertices = 1, .num_faces = 21}, limits).ok());
  EXPECT_FALSE(CheckCounts({.num_vertices = 1, .num_frames = 4}, limits).ok());
}

TEST(MeshLimitsTest, SequencesAreLimitedInBytesToo) {
  const MeshCounts counts = {.num_vertices = 10, .num_frames = 5};
  EXPECT_EQ(counts.position_bytes(), 600u);
  EXPECT_THAT(CheckSequenceCounts(counts, {.max_sequence_bytes = 600}), IsOk());
  EXPECT_THAT(CheckSequenceCounts(counts, {.max_sequence_bytes = 599}),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("599 bytes")));
  EXPECT_FALSE(CheckSequenceCounts(counts, {.max_frames = 4}).ok());
}

}  // namespace
}  // namespace pleat
