#include "service_gauges.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pleat {
namespace {

constexpr JobState kJobStates[] = {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                                   JobState::kFailed, JobState::kCancelled};

void AddMemoryGauge(const std::string& owner, std::function<uint64_t()> bytes,
                    ServerMetrics* metrics) {
  metrics->AddGauge("pleat_memory_bytes", "Memory that is reserved now, by owner",
                    {{"owner", owner}},
                    [bytes = std::move(bytes)] { return static_cast<double>(bytes()); });
}

// A value of each project; those without a label of their own are added up.
void AddProjectSeries(const std::string& name, const std::string& help, bool is_counter,
                      LocalCharacterService* service, ServerMetrics* metrics,
                      double (*value)(const ProjectUse&)) {
  metrics->AddSeries(name, help, is_counter, [service, metrics, value] {
    std::map<std::string, double> by_label;
    for (const ProjectUse& use : service->ProjectUses()) {
      by_label[metrics->project_labels().LabelOf(use.project)] += value(use);
    }
    std::vector<ServerMetrics::Sample> samples;
    for (const auto& [label, sum] : by_label) samples.push_back({{{"project", label}}, sum});
    return samples;
  });
}

void AddProjectJobs(LocalCharacterService* service, ServerMetrics* metrics) {
  metrics->AddSeries("pleat_project_jobs", "Jobs by project and state", false, [service, metrics] {
    std::map<ServerMetrics::Labels, double> by_labels;
    for (const ProjectUse& use : service->ProjectUses()) {
      const std::string label = metrics->project_labels().LabelOf(use.project);
      for (const JobState state : kJobStates) {
        const auto num = use.jobs.find(JobStateName(state));
        by_labels[{{"project", label}, {"state", JobStateName(state)}}] +=
            num == use.jobs.end() ? 0 : static_cast<double>(num->second);
      }
    }
    std::vector<ServerMetrics::Sample> samples;
    for (const auto& [labels, num] : by_labels) samples.push_back({labels, num});
    return samples;
  });
}

void AddProjectMetrics(LocalCharacterService* service, ServerMetrics* metrics) {
  AddProjectJobs(service, metrics);
  AddProjectSeries("pleat_project_stored_bytes", "Stored files by project", false, service, metrics,
                   [](const ProjectUse& use) { return static_cast<double>(use.stored_bytes); });
  AddProjectSeries("pleat_project_frames_total", "Frames evaluated and decoded, by project", true,
                   service, metrics, [](const ProjectUse& use) { return use.frames; });
  AddProjectSeries("pleat_project_job_cpu_seconds_total", "Processor time of jobs, by project",
                   true, service, metrics,
                   [](const ProjectUse& use) { return use.job_cpu_seconds; });
}

}  // namespace

void AddServiceGauges(LocalCharacterService* service, ServerMetrics* metrics) {
  for (const JobState state : kJobStates) {
    metrics->AddGauge("pleat_jobs", "Jobs by state", {{"state", JobStateName(state)}},
                      [service, state] { return 1. * service->CountJobsInState(state); });
  }
  AddProjectMetrics(service, metrics);
  MemoryOwners* const memory = &service->memory();
  AddMemoryGauge(
      "models", [service] { return service->model_bytes(); }, metrics);
  for (const auto& [owner, budget] :
       {std::pair("decoders", &memory->decoders), std::pair("encoders", &memory->encoders),
        std::pair("uploads", &memory->uploads), std::pair("jobs", &memory->jobs)}) {
    AddMemoryGauge(
        owner, [budget = budget] { return budget->used_bytes(); }, metrics);
  }
  metrics->AddGauge("pleat_memory_limit_bytes", "What --memory-bytes allows all owners together",
                    {}, [memory] { return static_cast<double>(memory->all.capacity_bytes()); });
  metrics->AddGauge("pleat_disk_free_bytes",
                    "Free bytes of the disk with the data folder; -1 = "
                    "the disk does not answer",
                    {}, [service] { return service->FreeDiskBytes(); });
  metrics->AddGauge("pleat_quarantined_files", "Files in the quarantine", {},
                    [service] { return 1. * service->NumQuarantinedFiles(); });
}

void AddNetworkGauges(const GrpcServer* server, ServerMetrics* metrics) {
  AddMemoryGauge(
      "requests", [server] { return server->memory_use().requests; }, metrics);
  AddMemoryGauge(
      "streams", [server] { return server->memory_use().streams; }, metrics);
  AddMemoryGauge(
      "messages", [server] { return server->memory_use().messages; }, metrics);
  metrics->AddGauge("pleat_connections", "Open connections", {},
                    [server] { return 1. * server->num_connections(); });
  metrics->AddGauge("pleat_refused_connections", "Connections refused since the start", {},
                    [server] { return static_cast<double>(server->num_refused_connections()); });
  if (!server->certificate_expiry()) return;
  metrics->AddGauge(
      "pleat_certificate_expiry_timestamp_seconds",
      "When the TLS certificate on the disk expires; 0 = it cannot be read", {},
      [server] { return static_cast<double>(server->certificate_expiry().value_or(0)); });
}

}  // namespace pleat
