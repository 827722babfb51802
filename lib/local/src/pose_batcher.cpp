#include "pleat/local/pose_batcher.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

namespace pleat {
namespace {

constexpr size_t kExpectedModels = 16;

}  // namespace

void PoseBatcher::MakeBatches() {
  waiting_.reserve(kExpectedModels);
  for (int t = 0; t < executor_->num_threads(); ++t) {
    auto batch = std::make_unique<Batch>();
    batch->works.reserve(static_cast<size_t>(most_together_));
    batch->queries.reserve(static_cast<size_t>(most_together_));
    unused_.push_back(std::move(batch));
  }
  has_batches_ = true;
}

void PoseBatcher::Submit(const CharacterModel* model, PoseWork* work) {
  {
    std::lock_guard lock(mutex_);
    if (!has_batches_) MakeBatches();
    auto line = std::find_if(waiting_.begin(), waiting_.end(),
                             [model](const Line& line) { return line.model == model; });
    if (line == waiting_.end()) line = waiting_.insert(line, Line{.model = model});
    work->next_waiting_ = nullptr;
    (line->size == 0 ? line->first : line->last->next_waiting_) = work;
    line->last = work;
    ++line->size;
  }
  executor_->Post([this, model] { Run(model); });  // small enough for std::function itself
}

std::unique_ptr<PoseBatcher::Batch> PoseBatcher::TakeBatch(const CharacterModel* model) {
  std::lock_guard lock(mutex_);
  const auto line = std::find_if(waiting_.begin(), waiting_.end(),
                                 [model](const Line& line) { return line.model == model; });
  if (line == waiting_.end()) return nullptr;
  // An equal share for every thread: together is cheaper, but not than a core that does nothing.
  const auto num_threads = static_cast<size_t>(executor_->num_threads());
  const size_t share = (line->size + num_threads - 1) / num_threads;
  // Every thread of the executor has at most one.
  std::unique_ptr<Batch> batch = std::move(unused_.back());
  unused_.pop_back();
  for (size_t i = 0; i < std::min(share, static_cast<size_t>(most_together_)); ++i) {
    batch->works.push_back(line->first);
    line->first = line->first->next_waiting_;
    --line->size;
  }
  if (line->size == 0) {
    *line = waiting_.back();
    waiting_.pop_back();
  }
  return batch;
}

void PoseBatcher::Run(const CharacterModel* model) {
  std::unique_ptr<Batch> batch = TakeBatch(model);
  if (batch == nullptr) return;
  size_t num_prepared = 0;
  for (PoseWork* work : batch->works) {
    PoseQuery query;
    if (work->Prepare(&query)) {
      batch->queries.push_back(query);
      batch->works[num_prepared++] = work;
    } else {
      work->Evaluated(nullptr, 0, 0);
    }
  }
  batch->works.resize(num_prepared);
  if (num_prepared > 0) Evaluate(batch.get());
  batch->works.clear();
  batch->queries.clear();
  std::lock_guard lock(mutex_);
  unused_.push_back(std::move(batch));
}

void PoseBatcher::Evaluate(Batch* batch) {
  std::vector<PoseQuery>& queries = batch->queries;
  const auto start = std::chrono::steady_clock::now();
  try {
    batch->works.front()->evaluator().EvaluateBatch(queries);
  } catch (const std::bad_alloc&) {
    for (PoseQuery& query : queries) {
      query.status = absl::ResourceExhaustedError("the server has not enough memory for this pose");
    }
  }
  const double evaluate_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  for (size_t q = 0; q < queries.size(); ++q) {
    batch->works[q]->Evaluated(&queries[q], evaluate_us, static_cast<int>(queries.size()));
  }
}

}  // namespace pleat
