// Poses of one model that wait at the same time are evaluated together.
#pragma once

#include <deque>
#include <map>
#include <mutex>

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
};

// A matrix product of several poses reads the model from memory once. Every work holds one turn of
// the executor, so sessions of other models wait for at most one batch in place of one pose, and
// the work that has waited longest is always in the next batch of its model. Thread-safe.
class PoseBatcher {
 public:
  // most_together: 1 evaluates one by one.
  PoseBatcher(Executor* executor, int most_together)
      : executor_(executor), most_together_(most_together) {}

  void Submit(const CharacterModel* model, PoseWork* work);

 private:
  void Run(const CharacterModel* model);

  Executor* const executor_;
  const int most_together_;
  std::mutex mutex_;
  std::map<const CharacterModel*, std::deque<PoseWork*>> waiting_;  // not empty; by mutex_
};

}  // namespace pleat
