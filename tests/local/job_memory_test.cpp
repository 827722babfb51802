#include "pleat/local/job_memory.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

SequenceInfo ClipOf(int num_frames, int num_vertices) {
  SequenceInfo clip;
  clip.num_frames = num_frames;
  clip.num_vertices = num_vertices;
  clip.size_bytes = uint64_t{12} * num_frames * num_vertices;
  return clip;
}

// The peaks that were measured, without the 25 MB of the program itself (docs/performance.md).
TEST(JobMemoryTest, CoversWhatWasMeasured) {
  EXPECT_GT(TrainingBytes({ClipOf(175, 9971)}), 169'000'000u);
  EXPECT_GT(TrainingBytes({ClipOf(1000, 9729)}), 511'000'000u);
  EXPECT_GT(TrainingBytes({ClipOf(10'000, 9971)}), 1'650'000'000u);
  EXPECT_GT(CompressionBytes(ClipOf(175, 9971)), 48'000'000u);
  EXPECT_GT(CompressionBytes(ClipOf(1000, 9729)), 238'000'000u);
}

TEST(JobMemoryTest, CountsAllClips) {
  const SequenceInfo clip = ClipOf(5000, 10'000);
  EXPECT_GT(TrainingBytes({clip, clip}), TrainingBytes({clip}) + clip.size_bytes);
}

}  // namespace
}  // namespace pleat
