// The studio: Pleat in a browser. It serves the page, and to it the RPCs of this server, live
// sessions, and what a page needs beyond them (docs/guide/studio.md).
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/service/limits.h"

namespace pleat {

struct StudioOptions {
  std::string listen = "127.0.0.1:7321";  // HOST:PORT; port 0 takes any free one
  // Further names ("studio.example.com") under which browsers reach it, through a proxy.
  std::vector<std::string> hosts{};
  std::string scratch_dir{};  // for uploads while they arrive; it is emptied
  ServiceLimits limits{};
  MemoryBudget* memory = nullptr;  // must outlive the server; null: not counted
  std::string version{};           // that the page shows
  // The ids of a model and of its sequences, which callers without a token see and cannot change.
  // Empty: they see what the server lets them see.
  std::set<std::string> shared{};
};

class StudioServer {
 public:
  // `server` must outlive it. The errors are those of HttpServer::Start.
  static absl::StatusOr<std::unique_ptr<StudioServer>> Start(StudioOptions options,
                                                             GrpcServer* server);
  virtual ~StudioServer() = default;  // calls Shutdown

  virtual std::string address() const = 0;  // HOST:PORT, with the port that was taken
  // Closes all connections. Call it before GrpcServer::Shutdown, which waits for their calls.
  virtual void Shutdown() = 0;
};

}  // namespace pleat
