// What Prometheus asks the server for.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/metrics/project_labels.h"

namespace pleat {

// Counters and histograms of calls, and gauges that are read when somebody asks. Thread-safe.
class ServerMetrics {
 public:
  using Labels = std::map<std::string, std::string>;

  ServerMetrics();
  ~ServerMetrics();
  ServerMetrics(const ServerMetrics&) = delete;
  ServerMetrics& operator=(const ServerMetrics&) = delete;

  // A call of the RPC `method`, "/pleat.v1.JobService/GetJob", begins or ends. Methods of other
  // packages than pleat and grpc are counted together, so that no client can make up labels.
  // status: the name of a code, "OK". seconds: from the first message to the status.
  void CallStarted(const std::string& method);
  void CallEnded(const std::string& method, const std::string& status, double seconds);
  // A call that has ended was one of this project; empty: of nobody who was let in. Its label is
  // that of project_labels().
  void CallOfProject(const std::string& project);
  // A call was refused for a limit, which the program names.
  void CallRefused(const std::string& limit);

  // A frame was evaluated ("query"), encoded ("encode"), or is on its way to the client ("send"),
  // and that took so long. step: one of these three.
  void FrameStep(const std::string& step, double seconds);
  // A job has been in `stage` for so long. stage: a name that the program knows, never one from
  // outside.
  void JobStage(const std::string& stage, double seconds);

  // A gauge whose value `read` returns, from any thread. One name may come with several labels; the
  // help of the first counts.
  void AddGauge(const std::string& name, const std::string& help, const Labels& labels,
                std::function<double()> read);

  // Values that `read` returns all at once, from any thread, each with its labels. is_counter: they
  // never fall while the process lives.
  struct Sample {
    Labels labels;
    double value = 0;
  };
  void AddSeries(const std::string& name, const std::string& help, bool is_counter,
                 std::function<std::vector<Sample>()> read);

  ProjectLabels& project_labels() { return project_labels_; }

  // All metrics in the text format of Prometheus.
  std::string Text() const;
  // Answers GET /metrics at HOST:PORT until StopServing. kUnavailable when the address cannot be
  // bound.
  absl::Status Serve(const std::string& address);
  // Call it before anything ends that the gauges read.
  void StopServing();

 private:
  class Impl;
  ProjectLabels project_labels_;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace pleat
