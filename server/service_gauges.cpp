#include "service_gauges.h"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace pleat {
namespace {

void AddMemoryGauge(const std::string& owner, std::function<uint64_t()> bytes,
                    ServerMetrics* metrics) {
  metrics->AddGauge("pleat_memory_bytes", "Memory that is reserved now, by owner",
                    {{"owner", owner}},
                    [bytes = std::move(bytes)] { return static_cast<double>(bytes()); });
}

}  // namespace

void AddServiceGauges(LocalCharacterService* service, ServerMetrics* metrics) {
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled}) {
    metrics->AddGauge("pleat_jobs", "Jobs by state", {{"state", JobStateName(state)}},
                      [service, state] { return 1. * service->CountJobsInState(state); });
  }
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
