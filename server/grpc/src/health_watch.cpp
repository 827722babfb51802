#include "health_watch.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

namespace pleat {
namespace {

constexpr const char* kStoringServices[] = {"pleat.v1.SequenceService", "pleat.v1.JobService",
                                            "pleat.v1.CompressedSequenceService", kReadyName};
constexpr const char* kOtherServices[] = {"pleat.v1.ModelService", "pleat.v1.PoseService"};

}  // namespace

HealthWatch::HealthWatch(grpc::HealthCheckServiceInterface* health,
                         std::function<absl::Status()> probe, std::chrono::milliseconds period)
    : health_(health), probe_(std::move(probe)), period_(period) {
  for (const char* service : kOtherServices) health_->SetServingStatus(service, true);
  Show(probe_ ? probe_() : absl::OkStatus());
  if (probe_) thread_ = std::thread([this] { Run(); });
}

HealthWatch::~HealthWatch() {
  stop_.Set();
  if (thread_.joinable()) thread_.join();
}

void HealthWatch::Run() {
  while (stop_.Pause(period_)) {
    const absl::Status status = probe_();  // a disk in trouble may take long to answer
    if (!stop_.is_set()) Show(status);
  }
}

void HealthWatch::Show(const absl::Status& status) {
  for (const char* service : kStoringServices) health_->SetServingStatus(service, status.ok());
  if (status.ok() != can_store_) {
    if (status.ok()) {
      spdlog::info("the server can store again");
    } else {
      spdlog::error("the server cannot store anything: {}", std::string(status.message()));
    }
  }
  can_store_ = status.ok();
}

}  // namespace pleat
