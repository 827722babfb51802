#include "pleat/local/job_memory.h"

#include <algorithm>

namespace pleat {
namespace {

constexpr uint64_t kFixedBytes = uint64_t{32} << 20;
// What is learned from: it grows with the frames until the learner picks some of them.
constexpr uint64_t kLearningBytesPerValue = 100;  // for each vertex of each frame
constexpr uint64_t kLearningBytesPerVertex = 48'000;

// The frames as three floats for each vertex.
uint64_t ClipBytes(const SequenceInfo& clip) {
  return uint64_t{12} * static_cast<uint64_t>(clip.num_vertices) *
         static_cast<uint64_t>(clip.num_frames);
}

}  // namespace

uint64_t TrainingBytes(const std::vector<SequenceInfo>& clips) {
  uint64_t frames = 0, largest_file = 0, learning = 0;
  for (const SequenceInfo& clip : clips) {
    frames += ClipBytes(clip);
    largest_file = std::max(largest_file, clip.size_bytes);
    const auto num_vertices = static_cast<uint64_t>(clip.num_vertices);
    const auto num_frames = static_cast<uint64_t>(clip.num_frames);
    learning = std::max(learning, num_vertices * std::min(kLearningBytesPerVertex,
                                                          kLearningBytesPerValue * num_frames));
  }
  // The file of a clip is in memory beside its frames while it is read, before the learning begins.
  return kFixedBytes + std::max(frames + largest_file, frames + frames / 4 + learning);
}

uint64_t CompressionBytes(const SequenceInfo& clip) {
  return kFixedBytes + std::max(ClipBytes(clip) + clip.size_bytes, 3 * ClipBytes(clip));
}

}  // namespace pleat
