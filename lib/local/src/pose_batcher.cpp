#include "pleat/local/pose_batcher.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <vector>

namespace pleat {

void PoseBatcher::Submit(const CharacterModel* model, PoseWork* work) {
  {
    std::lock_guard lock(mutex_);
    waiting_[model].push_back(work);
  }
  executor_->Post([this, model] { Run(model); });
}

void PoseBatcher::Run(const CharacterModel* model) {
  std::vector<PoseWork*> works;
  {
    std::lock_guard lock(mutex_);
    const auto waiting = waiting_.find(model);
    if (waiting == waiting_.end()) return;  // an earlier turn has taken them all
    // An equal share for every thread: together is cheaper, but not than a core that does nothing.
    const size_t share = (waiting->second.size() + executor_->num_threads() - 1) /
                         static_cast<size_t>(executor_->num_threads());
    const size_t count = std::min(share, static_cast<size_t>(most_together_));
    works.assign(waiting->second.begin(), waiting->second.begin() + static_cast<ptrdiff_t>(count));
    waiting->second.erase(waiting->second.begin(),
                          waiting->second.begin() + static_cast<ptrdiff_t>(count));
    if (waiting->second.empty()) waiting_.erase(waiting);
  }
  std::vector<PoseQuery> queries;
  std::vector<PoseWork*> prepared;
  for (PoseWork* work : works) {
    PoseQuery query;
    if (work->Prepare(&query)) {
      queries.push_back(query);
      prepared.push_back(work);
    } else {
      work->Evaluated(nullptr, 0, 0);
    }
  }
  if (queries.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  try {
    prepared.front()->evaluator().EvaluateBatch(queries);
  } catch (const std::bad_alloc&) {
    for (PoseQuery& query : queries) {
      query.status = absl::ResourceExhaustedError("the server has not enough memory for this pose");
    }
  }
  const double evaluate_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  for (size_t q = 0; q < queries.size(); ++q) {
    prepared[q]->Evaluated(&queries[q], evaluate_us, static_cast<int>(queries.size()));
  }
}

}  // namespace pleat
