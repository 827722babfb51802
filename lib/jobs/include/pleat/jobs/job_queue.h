// The jobs that wait, and whose turn it is.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pleat/jobs/job_state_machine.h"

namespace pleat {

// Clients take turns: the next job is the oldest one of the client that got its last turn the
// longest ago, so that a client with a thousand jobs delays another by one job. With one client it
// is a plain queue. Not thread-safe.
class JobQueue {
 public:
  using Job = std::shared_ptr<JobStateMachine>;

  void Add(Job job, const std::string& client);
  // Ahead of all others of its client.
  void AddFirst(Job job, const std::string& client);
  bool Remove(const Job& job);  // false when it does not wait

  bool empty() const { return waiting_.empty(); }
  size_t size() const { return waiting_.size(); }
  int NumOf(const std::string& client) const;
  int NumOfProject(const std::string& project) const;
  std::vector<Job> jobs() const;  // in the order in which they came

  using MayRun = std::function<bool(const JobStateMachine& job)>;
  // The job whose turn it is among those that may run; null when there is none. Empty: all may.
  Job Next(const MayRun& may_run = {}) const;
  // Takes the turn of its client for a job that waits.
  void Take(const Job& job);

 private:
  struct Waiting {
    Job job;
    std::string client;
  };

  std::deque<Waiting> waiting_;
  std::map<std::string, uint64_t> last_turns_;  // by client; those without one are not there
  uint64_t num_turns_ = 0;
};

}  // namespace pleat
