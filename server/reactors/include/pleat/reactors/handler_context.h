// What every handler gets: the services of its project, the threads, and what all calls of a server
// share.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pleat/base/executor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/base/project.h"
#include "pleat/identity/token_registry.h"
#include "pleat/reactors/live_registry.h"
#include "pleat/reactors/open_calls.h"
#include "pleat/reactors/running_calls.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/pose_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

struct HandlerContext;

// What the calls of a server share, whatever their project. It outlives all of them.
struct ServerCalls {
  TokenRegistry* tokens = nullptr;  // who may call; null: everybody
  // For large requests while they are worked on, and for what each stream holds; null: not counted.
  MemoryBudget* request_memory = nullptr;
  MemoryBudget* stream_memory = nullptr;
  int max_open_streams = 0;
  std::atomic<int> num_open_streams = 0;
  int max_streams_per_client = 0;      // 0: no limit
  std::atomic<bool> draining = false;  // the server shuts down: new calls are refused
  OpenCalls open_calls;                // streams included
  RunningCalls running_calls;          // by client
  LiveRegistry live_sessions;
  // Hears how long a step of a frame took: "query", "encode" or "send". Empty: nobody listens.
  std::function<void(const char* step, double seconds)> on_frame_step{};
  void TellFrameStep(const char* step, double seconds) const {
    if (on_frame_step) on_frame_step(step, seconds);
  }
  // The context of a project, which lives as long as the server. Empty: there is one for all.
  std::function<HandlerContext*(const std::string& project)> of_project{};
  // The context of a view that shows the content with these ids alone, which lives as long.
  std::function<HandlerContext*(HandlerContext* all, const std::string& ids)> of_share{};
};

struct HandlerContext {
  std::string project = kDefaultProject;
  // Each handler uses one of the services; a test of a handler sets that one.
  SequenceService* sequences = nullptr;
  JobService* jobs = nullptr;
  ModelService* models = nullptr;
  PoseService* poses = nullptr;
  CompressedSequenceService* compressed_sequences = nullptr;

  Executor* pose_executor = nullptr;     // for milliseconds of computation
  Executor* storage_executor = nullptr;  // for answers out of the catalog
  // For uploads, downloads and decoding, which take seconds: else five uploads at their ends would
  // hold up every question about a job.
  Executor* transfer_executor = nullptr;

  std::shared_ptr<ServerCalls> calls = std::make_shared<ServerCalls>();
};

// What a stream takes at most beside what its own handler counts: the call, its windows and a
// message in each direction.
inline constexpr uint64_t kStreamBytes = uint64_t{256} << 10;

// Counts one open stream and its memory as long as it lives.
class StreamSlot {
 public:
  explicit StreamSlot(HandlerContext* context, uint64_t bytes = kStreamBytes)
      : calls_(context->calls.get()),
        granted_(++calls_->num_open_streams <= calls_->max_open_streams) {
    if (granted_ && calls_->stream_memory != nullptr) {
      memory_ = calls_->stream_memory->Reserve(bytes, "a stream");
    }
  }
  ~StreamSlot() { --calls_->num_open_streams; }
  StreamSlot(const StreamSlot&) = delete;
  StreamSlot& operator=(const StreamSlot&) = delete;

  // Why the stream must not begin: the server shuts down, too many others are open, or there is no
  // memory for it.
  absl::Status status() const;

 private:
  ServerCalls* calls_;
  bool granted_;
  absl::StatusOr<Reservation> memory_ = Reservation();
};

}  // namespace pleat
