// Evaluates poses of one model together when they wait at the same time
// (docs/method/streams.md#batches).
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "pleat/base/executor.h"
#include "pleat/character/pose_evaluator.h"

namespace pleat {

// What one session has to do for its next frame. A work is in the batcher at most once: from Submit
// until Evaluated is called. The three calls come in this order, on one thread of the executor.
class PoseWork {
 public:
  // Fills in what to show now, which may have changed since Submit. Returns false when there is
  // nothing to evaluate; Evaluated is then called with null.
  virtual bool Prepare(PoseQuery* query) = 0;
  // An evaluator that may evaluate the queries of all works in the batch. The work itself must not
  // use it until Evaluated is called.
  virtual PoseEvaluator& evaluator() = 0;
  // Takes the evaluated query, whose status may be an error, or null when there was nothing.
  // evaluate_us: the elapsed time of the evaluation, in microseconds, for all `num_together`
  // queries together. It may submit the work again or destroy it, so the batcher does not touch it
  // after.
  virtual void Evaluated(const PoseQuery* query, double evaluate_us, int num_together) = 0;

 protected:
  ~PoseWork() = default;

 private:
  friend class PoseBatcher;
  // The next work that waits for the same model; guarded by the batcher's mutex.
  PoseWork* next_waiting_ = nullptr;
};

// A matrix product of several poses reads the model from memory once, which makes a batch cheaper
// than its poses one by one. Every work brings at most one turn of the executor, so sessions of
// other models wait for at most one batch where they would have waited for one pose. The work that
// has waited longest is always in the next batch of its model. Nothing is allocated for a frame,
// unless more models have work at once than ever before. Thread-safe.
class PoseBatcher {
 public:
  // most_together: the largest number of works in a batch; 1 evaluates them one by one. The
  // executor may be constructed after the batcher, but before the first Submit.
  PoseBatcher(Executor* executor, int most_together)
      : executor_(executor), most_together_(most_together) {}

  // Queues `work`, which keeps `model` alive. A work must not be queued twice; it has left the
  // batcher when Evaluated is called.
  void Submit(const CharacterModel* model, PoseWork* work);

 private:
  // The works that wait for one model, in the order of Submit, as a list through the works
  // themselves.
  struct Line {
    const CharacterModel* model = nullptr;
    PoseWork* first = nullptr;
    PoseWork* last = nullptr;
    size_t size = 0;
    size_t num_turns = 0;  // of the executor, still to come: never fewer than works
  };
  // Works that are evaluated together. Batches are used again for the sake of their memory.
  struct Batch {
    std::vector<PoseWork*> works;  // once prepared, works[i] has queries[i]
    std::vector<PoseQuery> queries;
  };

  // Allocates the batches. This happens at the first Submit, since the executor may be constructed
  // after the batcher. Call it with mutex_ held.
  void MakeBatches();
  // One turn of the executor.
  void Run(const CharacterModel* model);
  // Returns the line of `model`, or waiting_.end(). Call it with mutex_ held.
  std::vector<Line>::iterator FindLine(const CharacterModel* model);
  // Removes a line whose turns have all come, so that it is empty too.
  void RemoveWithoutTurns(std::vector<Line>::iterator line);
  // Takes the next batch of `model`, for a turn that has come. Returns null when earlier turns have
  // taken all works.
  std::unique_ptr<Batch> TakeBatch(const CharacterModel* model);
  // Evaluates a batch that is prepared and not empty, and hands the queries to their works.
  static void Evaluate(Batch* batch);

  Executor* const executor_;
  const int most_together_;
  std::mutex mutex_;
  // All three are guarded by mutex_.
  std::vector<Line> waiting_;                   // the lines with turns to come, in any order
  std::vector<std::unique_ptr<Batch>> unused_;  // one for each thread without a batch
  bool has_batches_ = false;
};

}  // namespace pleat
