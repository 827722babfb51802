#include "pleat/jobs/job_queue.h"

#include <algorithm>
#include <utility>

namespace pleat {
namespace {

// Turns of clients that have nothing in the queue are forgotten beyond this number.
constexpr size_t kMaxRememberedClients = 1000;

}  // namespace

void JobQueue::Add(Job job, const std::string& client) {
  waiting_.push_back({std::move(job), client});
}

void JobQueue::AddFirst(Job job, const std::string& client) {
  waiting_.push_front({std::move(job), client});
}

bool JobQueue::Remove(const Job& job) {
  return std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.job == job; }) > 0;
}

int JobQueue::NumOf(const std::string& client) const {
  return static_cast<int>(std::ranges::count(waiting_, client, &Waiting::client));
}

int JobQueue::NumOfProject(const std::string& project) const {
  return static_cast<int>(std::ranges::count_if(waiting_, [&](const Waiting& waiting) {
    return waiting.job->snapshot().info.project == project;
  }));
}

std::vector<JobQueue::Job> JobQueue::jobs() const {
  std::vector<Job> jobs;
  for (const Waiting& waiting : waiting_) jobs.push_back(waiting.job);
  return jobs;
}

JobQueue::Job JobQueue::Next(const MayRun& may_run) const {
  Job best;
  uint64_t best_turn = UINT64_MAX;
  for (const Waiting& waiting : waiting_) {
    const auto turn = last_turns_.find(waiting.client);
    const uint64_t last = turn == last_turns_.end() ? 0 : turn->second;
    if (last >= best_turn || (may_run && !may_run(*waiting.job))) continue;
    best = waiting.job;
    best_turn = last;
  }
  return best;
}

void JobQueue::Take(const Job& job) {
  const auto place = std::ranges::find(waiting_, job, &Waiting::job);
  if (place == waiting_.end()) return;
  if (last_turns_.size() >= kMaxRememberedClients) last_turns_.clear();
  last_turns_[place->client] = ++num_turns_;
  waiting_.erase(place);
}

}  // namespace pleat
