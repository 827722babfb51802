// How much memory a job will take, which is reserved before it starts.
#pragma once

#include <cstdint>
#include <vector>

#include "pleat/service/sequence_service.h"

namespace pleat {

// Bounds of what was measured (docs/performance.md, "Memory of jobs"), from the sizes of the clips
// alone: all frames are in memory while a job runs.
uint64_t TrainingBytes(const std::vector<SequenceInfo>& clips);
uint64_t CompressionBytes(const SequenceInfo& clip);

}  // namespace pleat
