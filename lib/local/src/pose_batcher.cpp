// Two queues meet here. The executor decides when a thread works, by turns; the lines in waiting_
// decide what it does in its turn. Submit puts a work at the end of its model's line and then posts
// one turn for the model, if there are fewer turns to come than works. A turn does not belong to
// the work that brought it: it takes the works at the front of the line, several at once if they
// are there. The turns that these works brought serve works that come later, or find an empty line
// and return. A turn takes at least one work where there is one, so there are never more works in a
// line than turns to come: no work is forgotten. There are also never more turns than works have
// been in the line at once. Sessions that come back at once would otherwise bring several turns for
// each that is used, and under load the round of the executor would grow for ever.
//
// How many a turn takes: an equal share of the line for each thread, rounded up. Two works on two
// threads are two batches of one, since a core that does nothing costs more than a batch saves.
//
// A work has one owner at a time. While it waits, its link belongs to mutex_; from TakeBatch on, it
// belongs to the thread that took it, until Evaluated is called. Prepare, evaluation and Evaluated
// run without the mutex. Evaluated encodes and sends the frame, and the session may submit itself
// again or be gone before the call returns. So no work is touched after it was told, and those with
// a query are told when the whole batch has been evaluated, since it borrows their memory. Prepare
// comes as late as possible: it picks the pose, and a newer one may have replaced the pose that
// Submit was called for.
//
// `model` is a key here and is never dereferenced. A late turn may outlive its model, and so does
// the line until then; another model that has its address by then continues that line.
//
// What is allocated, and when: as many batches as the executor has threads, with the first Submit;
// room for kExpectedModels lines at the same time; nothing for a frame. Works are linked through a
// member of their own, and the task of a turn, two pointers, fits into std::function itself.
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
  unused_.reserve(static_cast<size_t>(executor_->num_threads()));
  for (int t = 0; t < executor_->num_threads(); ++t) {
    auto batch = std::make_unique<Batch>();
    batch->works.reserve(static_cast<size_t>(most_together_));
    batch->queries.reserve(static_cast<size_t>(most_together_));
    unused_.push_back(std::move(batch));
  }
  has_batches_ = true;
}

std::vector<PoseBatcher::Line>::iterator PoseBatcher::FindLine(const CharacterModel* model) {
  return std::find_if(waiting_.begin(), waiting_.end(),
                      [model](const Line& line) { return line.model == model; });
}

void PoseBatcher::Submit(const CharacterModel* model, PoseWork* work) {
  {
    std::lock_guard lock(mutex_);
    if (!has_batches_) MakeBatches();
    auto line = FindLine(model);
    if (line == waiting_.end()) line = waiting_.insert(line, Line{.model = model});
    work->next_waiting_ = nullptr;
    (line->size == 0 ? line->first : line->last->next_waiting_) = work;
    line->last = work;
    if (++line->size <= line->num_turns) return;
    ++line->num_turns;
  }
  executor_->Post([this, model] { Run(model); });
}

void PoseBatcher::RemoveWithoutTurns(std::vector<Line>::iterator line) {
  if (line->num_turns > 0) return;
  *line = waiting_.back();  // the order of lines does not matter
  waiting_.pop_back();
}

std::unique_ptr<PoseBatcher::Batch> PoseBatcher::TakeBatch(const CharacterModel* model) {
  std::lock_guard lock(mutex_);
  const auto line = FindLine(model);
  --line->num_turns;
  if (line->size == 0) {
    RemoveWithoutTurns(line);
    return nullptr;
  }
  const auto num_threads = static_cast<size_t>(executor_->num_threads());
  const size_t share = (line->size + num_threads - 1) / num_threads;
  // There are as many batches as threads, and a turn has at most one, so one is there.
  std::unique_ptr<Batch> batch = std::move(unused_.back());
  unused_.pop_back();
  for (size_t i = 0; i < std::min(share, static_cast<size_t>(most_together_)); ++i) {
    batch->works.push_back(line->first);
    line->first = line->first->next_waiting_;
    --line->size;
  }
  RemoveWithoutTurns(line);
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
