#include "service_gauges.h"

namespace pleat {

void AddServiceGauges(LocalCharacterService* service, ServerMetrics* metrics) {
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled}) {
    metrics->AddGauge("pleat_jobs", "Jobs by state", {{"state", JobStateName(state)}},
                      [service, state] { return 1. * service->jobs().CountInState(state); });
  }
  const auto cache = [service] { return service->models().cache_stats(); };
  metrics->AddGauge("pleat_memory_bytes", "Memory by owner", {{"owner", "models"}},
                    [cache] { return static_cast<double>(cache().used_bytes); });
  metrics->AddGauge("pleat_memory_bytes", "", {{"owner", "decoders"}}, [service] {
    return static_cast<double>(service->compressed_sequences().decoder_bytes());
  });
  metrics->AddGauge("pleat_memory_bytes", "", {{"owner", "encoders"}}, [service] {
    return static_cast<double>(service->poses().encoders().used_bytes());
  });
  metrics->AddGauge("pleat_disk_free_bytes",
                    "Free bytes of the disk with the data folder; -1 = "
                    "the disk does not answer",
                    {}, [service] { return service->FreeDiskBytes(); });
  metrics->AddGauge("pleat_quarantined_files", "Files in the quarantine", {},
                    [service] { return 1. * service->NumQuarantinedFiles(); });
}

void AddNetworkGauges(const GrpcServer* server, ServerMetrics* metrics) {
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
