#include "pleat/metrics/server_metrics.h"

#include <prometheus/collectable.h>
#include <prometheus/counter.h>
#include <prometheus/exposer.h>
#include <prometheus/family.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <exception>
#include <mutex>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

// Seconds: from a query of 50 us to the upload of a long take.
const prometheus::Histogram::BucketBoundaries kSeconds = {50e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3,
                                                          5e-3,  10e-3,  20e-3,  50e-3,  .1,   .2,
                                                          .5,    1,      2,      5,      10,   60};

// Seconds: stages of jobs, from reading a small clip to learning from a long one.
const prometheus::Histogram::BucketBoundaries kStageSeconds = {.01, .05, .2, .5,  1,   2,   5,
                                                               10,  30,  60, 300, 900, 3600};

std::string MethodLabel(const std::string& method) {
  return absl::StartsWith(method, "/pleat.") || absl::StartsWith(method, "/grpc.") ? method
                                                                                   : "other";
}

using Samples = std::function<std::vector<ServerMetrics::Sample>()>;

// Metrics that are asked for their values in the moment of a scrape.
class ReadMetrics final : public prometheus::Collectable {
 public:
  void Add(const std::string& name, const std::string& help, bool is_counter, Samples read) {
    std::lock_guard lock(mutex_);
    Family& family = families_[name];
    if (family.help.empty()) family.help = help;
    family.is_counter = is_counter;
    family.reads.push_back(std::move(read));
  }

  std::vector<prometheus::MetricFamily> Collect() const override {
    std::lock_guard lock(mutex_);
    std::vector<prometheus::MetricFamily> result;
    for (const auto& [name, family] : families_) result.push_back(family.Read(name));
    return result;
  }

 private:
  struct Family {
    std::string help;
    bool is_counter = false;
    std::vector<Samples> reads;

    prometheus::MetricFamily Read(const std::string& name) const {
      prometheus::MetricFamily out;
      out.name = name;
      out.help = help;
      out.type = is_counter ? prometheus::MetricType::Counter : prometheus::MetricType::Gauge;
      for (const Samples& read : reads) {
        for (const ServerMetrics::Sample& sample : read()) {
          prometheus::ClientMetric metric;
          for (const auto& [label, value] : sample.labels) metric.label.push_back({label, value});
          (is_counter ? metric.counter.value : metric.gauge.value) = sample.value;
          out.metric.push_back(std::move(metric));
        }
      }
      return out;
    }
  };
  mutable std::mutex mutex_;
  std::map<std::string, Family> families_;  // guarded by mutex_
};

}  // namespace

class ServerMetrics::Impl {
 public:
  const std::shared_ptr<prometheus::Registry> registry = std::make_shared<prometheus::Registry>();
  const std::shared_ptr<ReadMetrics> read_metrics = std::make_shared<ReadMetrics>();
  prometheus::Family<prometheus::Counter>& calls =
      prometheus::BuildCounter()
          .Name("pleat_rpcs_total")
          .Help("Calls that have ended, by method and status")
          .Register(*registry);
  prometheus::Family<prometheus::Gauge>& open_calls = prometheus::BuildGauge()
                                                          .Name("pleat_rpcs_open")
                                                          .Help("Calls under way, by method")
                                                          .Register(*registry);
  prometheus::Family<prometheus::Histogram>& seconds =
      prometheus::BuildHistogram()
          .Name("pleat_rpc_seconds")
          .Help("How long calls took, streams from their begin to their end")
          .Register(*registry);
  prometheus::Family<prometheus::Histogram>& frame_seconds =
      prometheus::BuildHistogram()
          .Name("pleat_frame_seconds")
          .Help("How long frames took to evaluate, to encode and to hand over to the network")
          .Register(*registry);
  prometheus::Family<prometheus::Histogram>& stage_seconds =
      prometheus::BuildHistogram()
          .Name("pleat_job_stage_seconds")
          .Help("How long jobs were in each of their stages")
          .Register(*registry);
  prometheus::Family<prometheus::Counter>& project_calls =
      prometheus::BuildCounter()
          .Name("pleat_project_rpcs_total")
          .Help("Calls that have ended, by project")
          .Register(*registry);
  prometheus::Family<prometheus::Counter>& refusals =
      prometheus::BuildCounter()
          .Name("pleat_refused_rpcs_total")
          .Help("Calls that were refused for a limit, by limit")
          .Register(*registry);
  std::unique_ptr<prometheus::Exposer> exposer;  // ends first: it reads the others
};

// What is counted is there with 0 from the start, because a rate needs a value before the first
// event.
ServerMetrics::ServerMetrics() : impl_(std::make_unique<Impl>()) {
  for (const char* step : {"query", "encode", "send"}) {
    impl_->frame_seconds.Add({{"step", step}}, kSeconds);
  }
  for (const char* stage :
       {"read", "rig", "fit", "refine", "detail", "learn", "measure", "compress", "store"}) {
    impl_->stage_seconds.Add({{"stage", stage}}, kStageSeconds);
  }
  for (const char* limit : {"--memory-bytes", "--request-bytes", "--max-open-streams",
                            "--max-streams-per-client", "--max-queued-jobs-per-client"}) {
    impl_->refusals.Add({{"limit", limit}});
  }
}
ServerMetrics::~ServerMetrics() = default;

void ServerMetrics::CallStarted(const std::string& method) {
  impl_->open_calls.Add({{"method", MethodLabel(method)}}).Increment();
}

void ServerMetrics::CallEnded(const std::string& method, const std::string& status,
                              double seconds) {
  const std::string label = MethodLabel(method);
  impl_->open_calls.Add({{"method", label}}).Decrement();
  impl_->calls.Add({{"method", label}, {"status", status}}).Increment();
  impl_->seconds.Add({{"method", label}}, kSeconds).Observe(seconds);
}

void ServerMetrics::CallOfProject(const std::string& project) {
  impl_->project_calls.Add({{"project", project_labels_.LabelOf(project)}}).Increment();
}

void ServerMetrics::CallRefused(const std::string& limit) {
  impl_->refusals.Add({{"limit", limit}}).Increment();
}

void ServerMetrics::FrameStep(const std::string& step, double seconds) {
  impl_->frame_seconds.Add({{"step", step}}, kSeconds).Observe(seconds);
}

void ServerMetrics::JobStage(const std::string& stage, double seconds) {
  impl_->stage_seconds.Add({{"stage", stage}}, kStageSeconds).Observe(seconds);
}

void ServerMetrics::AddGauge(const std::string& name, const std::string& help, const Labels& labels,
                             std::function<double()> read) {
  AddSeries(name, help, /*is_counter=*/false, [labels, read = std::move(read)] {
    return std::vector<Sample>{{labels, read()}};
  });
}

void ServerMetrics::AddSeries(const std::string& name, const std::string& help, bool is_counter,
                              std::function<std::vector<Sample>()> read) {
  impl_->read_metrics->Add(name, help, is_counter, std::move(read));
}

std::string ServerMetrics::Text() const {
  std::vector<prometheus::MetricFamily> families = impl_->registry->Collect();
  for (prometheus::MetricFamily& family : impl_->read_metrics->Collect()) {
    families.push_back(std::move(family));
  }
  return prometheus::TextSerializer().Serialize(families);
}

absl::Status ServerMetrics::Serve(const std::string& address) {
  try {
    impl_->exposer = std::make_unique<prometheus::Exposer>(address, /*num_threads=*/1);
  } catch (const std::exception&) {  // CivetWeb says no more than that it failed
    return absl::UnavailableError(
        absl::StrCat("cannot answer metrics at '", address, "': the address is wrong or in use"));
  }
  impl_->exposer->RegisterCollectable(impl_->registry);
  impl_->exposer->RegisterCollectable(impl_->read_metrics);
  return absl::OkStatus();
}

void ServerMetrics::StopServing() { impl_->exposer.reset(); }

}  // namespace pleat
