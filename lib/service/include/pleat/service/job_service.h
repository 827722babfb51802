// Jobs: long computations that a service queues, runs and reports on.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "pleat/base/project.h"
#include "pleat/character/train_character.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/list_page.h"

namespace pleat {

// queued -> running -> succeeded | failed | cancelled; queued -> cancelled. A job that was running
// when the server stopped is queued again at the next start.
enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };
bool IsFinal(JobState state);
const char* JobStateName(JobState state);  // "queued", "running", ...

// What a job does: train a model, or compress one sequence.
using JobOptions = std::variant<TrainOptions, CompressOptions>;

struct TrainingRequest {
  std::vector<std::string> sequence_ids{};
  TrainOptions options{};
  std::string model_name{};  // empty: the first sequence's
  // The user's own rig as the text of a rig file (docs/formats/rig.md); empty: found automatically.
  std::string rig{};
  // Chosen by the caller at random; a call with the id of an earlier one makes no second job and
  // returns the first as it is now. Empty: every call makes a job.
  std::string request_id{};
  // Who asks, as the server knows it (CallOrigin); clients take turns in the queue, each with a
  // limit of its own. Empty in this process.
  std::string client{};
  absl::Duration model_ttl = kKeepForEver;  // how long the service keeps the model at least
};

struct CompressionRequest {
  std::string sequence_id{};
  CompressOptions options{};
  std::string request_id{};                  // as above
  std::string client{};                      // as above
  absl::Duration result_ttl = kKeepForEver;  // of the compressed sequence
};

struct JobInfo {
  std::string id;
  JobState state = JobState::kQueued;
  std::vector<std::string> sequence_ids;
  JobOptions options;
  std::string name;                          // of the result
  std::string rig_id;                        // hex SHA-256 of TrainingRequest::rig, or empty
  std::string request_id;                    // of the call that made it; services do not show it
  std::string client;                        // the same holds for this
  std::string project = kDefaultProject;     // and for this: who may see the job
  absl::Duration result_ttl = kKeepForEver;  // from the moment when the result is stored
  std::string stage;                // of the running computation: "rig", "fit", "encode", ...
  double fraction = 0;              // 0..1
  std::optional<double> objective;  // of the running optimizer
  std::optional<double> eta_seconds;
  std::vector<std::string> warnings;
  absl::Status error;     // why it failed or was cancelled
  std::string result_id;  // when it succeeded: the id of the model or the compressed sequence
  // When it was created, was started the last time, and ended. None: it has not come to that, or an
  // older version that wrote no times made the job.
  std::optional<absl::Time> created, started, ended;
};

// A job at one moment.
struct JobUpdate {
  JobInfo info;
  uint64_t revision = 0;  // grows with every change
};

// One job as one observer follows it. Thread-safe.
class JobSubscription {
 public:
  // Returns when no call of the listener is running; do not call it from there.
  virtual ~JobSubscription() = default;
  virtual JobUpdate current() const = 0;
  // Not OK when no further change will be seen although the job is not final: kUnavailable when
  // the service shuts down or cannot be reached any more.
  virtual absl::Status status() const = 0;
};

// Thread-safe. kNotFound for an id that the service does not have.
class JobService {
 public:
  virtual ~JobService() = default;

  // kAlreadyExists when the request_id belongs to a job of other sequences or of the other kind.
  virtual absl::StatusOr<JobInfo> CreateTraining(const TrainingRequest& request) = 0;
  virtual absl::StatusOr<JobInfo> CreateCompression(const CompressionRequest& request) = 0;
  virtual absl::StatusOr<JobInfo> Get(const std::string& id) = 0;
  // Oldest first. kInvalidArgument for a size out of range, or a token that this list did not give.
  virtual absl::StatusOr<Page<JobInfo>> ListPage(const PageRequest& request) = 0;
  // All pages together.
  absl::StatusOr<std::vector<JobInfo>> List() {
    return ReadAllPages<JobInfo>([this](const PageRequest& request) { return ListPage(request); });
  }
  // kFailedPrecondition when the job is final. A running job stops within a second.
  virtual absl::Status Cancel(const std::string& id) = 0;
  // Forgets a job that is final, and its request id; what it made stays. kFailedPrecondition when
  // the job is not final.
  virtual absl::Status Delete(const std::string& id) = 0;
  // Calls `listener` after every change of the job or of the subscription's status, from any
  // thread. The listener must be quick and must not call the subscription: the news may be read
  // as soon as it has returned.
  virtual absl::StatusOr<std::unique_ptr<JobSubscription>> Subscribe(
      const std::string& id, std::function<void()> listener) = 0;
};

// Calls `observe` with the job now, after every change and about four times a second in between,
// until the job is final or `observe` returns false. Steps between two calls may be missed.
absl::Status WatchJob(JobService& jobs, const std::string& id,
                      const std::function<bool(const JobInfo&)>& observe);

}  // namespace pleat
