// What every handler gets: the services, the threads, and what the calls of a server share.
#pragma once

#include <atomic>

#include "pleat/base/executor.h"
#include "pleat/base/memory_budget.h"
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

struct HandlerContext {
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
  MemoryBudget* request_memory =
      nullptr;                      // for large requests while they are worked on; null: none
  TokenRegistry* tokens = nullptr;  // who may call; null: everybody
  int max_open_streams = 0;
  std::atomic<int> num_open_streams = 0;
  int max_streams_per_client = 0;      // 0: no limit
  std::atomic<bool> draining = false;  // the server shuts down: new calls are refused
  OpenCalls open_calls;                // streams included
  RunningCalls running_calls;          // by client
  LiveRegistry live_sessions;
};

// Counts one open stream as long as it lives.
class StreamSlot {
 public:
  explicit StreamSlot(HandlerContext* context)
      : context_(context), granted_(++context->num_open_streams <= context->max_open_streams) {}
  ~StreamSlot() { --context_->num_open_streams; }
  StreamSlot(const StreamSlot&) = delete;
  StreamSlot& operator=(const StreamSlot&) = delete;

  // Why the stream must not begin: the server shuts down, or too many others are open.
  absl::Status status() const;

 private:
  HandlerContext* context_;
  bool granted_;
};

}  // namespace pleat
