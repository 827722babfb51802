// Poses of one model that wait at the same time are evaluated together.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "pleat/base/executor.h"
#include "pleat/character/pose_evaluator.h"

namespace pleat {

// What one session has to do for its next frame. It is in the batcher at most once.
class PoseWork {
 public:
  // Fills in what to show now, which may have changed since Submit; false: nothing.
  virtual bool Prepare(PoseQuery* query) = 0;
  // Evaluates for any session of the same model; nobody else uses it meanwhile.
  virtual PoseEvaluator& evaluator() = 0;
  // The query after its evaluation, or null when there was nothing. evaluate_us: elapsed time of
  // all queries that were evaluated together. The work may be gone when this returns.
  virtual void Evaluated(const PoseQuery* query, double evaluate_us, int num_together) = 0;

 protected:
  ~PoseWork() = default;

 private:
  friend class PoseBatcher;
  PoseWork* next_waiting_ = nullptr;  // for the same model; by the batcher's mutex
};

// A matrix product of several poses reads the model from memory once. Every work holds one turn of
// the executor, so sessions of other models wait for at most one batch in place of one pose, and
// the work that has waited longest is always in the next batch of its model. Allocates nothing for
// a frame, unless more models than ever before have work. Thread-safe.
class PoseBatcher {
 public:
  // most_together: 1 evaluates one by one.
  PoseBatcher(Executor* executor, int most_together)
      : executor_(executor), most_together_(most_together) {}

  void Submit(const CharacterModel* model, PoseWork* work);

 private:
  // What waits for one model, in the order of Submit: a list through the works themselves.
  struct Line {
    const CharacterModel* model = nullptr;
    PoseWork* first = nullptr;
    PoseWork* last = nullptr;
    size_t size = 0;
  };
  // What is evaluated together; its memory is used again.
  struct Batch {
    std::vector<PoseWork*> works;  // in `queries`' order, once they are prepared
    std::vector<PoseQuery> queries;
  };

  // With the first work, because the executor may be made after the batcher. With mutex_.
  void MakeBatches();
  void Run(const CharacterModel* model);
  // The next batch of `model`, null when there is none: an earlier turn has taken all works.
  std::unique_ptr<Batch> TakeBatch(const CharacterModel* model);
  static void Evaluate(Batch* batch);

  Executor* const executor_;
  const int most_together_;
  std::mutex mutex_;
  std::vector<Line> waiting_;                   // not empty, in any order; guarded by mutex_
  std::vector<std::unique_ptr<Batch>> unused_;  // one for each idle thread; guarded by mutex_
  bool has_batches_ = false;                    // guarded by mutex_
};

}  // namespace pleat
