// What the standard health service of gRPC answers.
#pragma once

#include <grpcpp/health_check_service_interface.h>

#include <chrono>
#include <functional>
#include <thread>

#include "absl/status/status.h"
#include "pleat/base/stop_signal.h"

namespace pleat {

// The name under which the whole server says whether it can do everything. The empty name, which
// most probes ask for, tells whether the process answers at all.
inline constexpr char kReadyName[] = "pleat.ready";

// Once in `period` it runs `probe`, which says why nothing can be stored. While that fails, the
// services that store something and kReadyName are NOT_SERVING; poses and models go on. A change is
// logged.
class HealthWatch {
 public:
  // `health` must outlive it.
  HealthWatch(grpc::HealthCheckServiceInterface* health, std::function<absl::Status()> probe,
              std::chrono::milliseconds period = std::chrono::seconds(2));
  ~HealthWatch();
  HealthWatch(const HealthWatch&) = delete;
  HealthWatch& operator=(const HealthWatch&) = delete;

 private:
  void Run();
  void Show(const absl::Status& status);

  grpc::HealthCheckServiceInterface* const health_;
  const std::function<absl::Status()> probe_;
  const std::chrono::milliseconds period_;
  bool can_store_ = true;  // of the thread
  StopSignal stop_;
  std::thread thread_;
};

}  // namespace pleat
