// What every handler gets.
#pragma once

#include <atomic>

#include "pleat/base/executor.h"
#include "pleat/reactors/live_registry.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/pose_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

struct HandlerContext {
  // Each handler uses one of them; a test of a handler sets that one.
  SequenceService* sequences = nullptr;
  JobService* jobs = nullptr;
  ModelService* models = nullptr;
  PoseService* poses = nullptr;
  CompressedSequenceService* compressed_sequences = nullptr;

  Executor* pose_executor = nullptr;     // milliseconds of computation
  Executor* storage_executor = nullptr;  // disk, catalogue, checking uploads
  int max_open_streams = 0;
  std::atomic<int> num_open_streams = 0;
  std::atomic<int> num_calls = 0;      // under way, streams included
  std::atomic<bool> draining = false;  // the server shuts down: new calls are refused
  LiveRegistry live_sessions;
};

// Counts one call as long as it lives.
class CallCounter {
 public:
  explicit CallCounter(HandlerContext* context) : context_(context) { ++context_->num_calls; }
  ~CallCounter() { --context_->num_calls; }
  CallCounter(const CallCounter&) = delete;
  CallCounter& operator=(const CallCounter&) = delete;

 private:
  HandlerContext* context_;
};

// Counts one open stream, which is a call, as long as it lives.
class StreamSlot {
 public:
  explicit StreamSlot(HandlerContext* context)
      : counter_(context),
        context_(context),
        granted_(++context->num_open_streams <= context->max_open_streams) {}
  ~StreamSlot() { --context_->num_open_streams; }
  StreamSlot(const StreamSlot&) = delete;
  StreamSlot& operator=(const StreamSlot&) = delete;

  absl::Status status() const;

 private:
  CallCounter counter_;
  HandlerContext* context_;
  bool granted_;
};

}  // namespace pleat
