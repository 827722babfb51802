// The network side of the server.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/executor.h"
#include "pleat/service/character_service.h"

namespace grpc {
class Channel;
}

namespace pleat {

struct ConnectionLimits {
  int max_connections = 4096;           // fewer where the process may have too few file descriptors
  int max_connections_per_peer = 1024;  // with one address
};

// Hears of every call, from any thread. status: a grpc::StatusCode.
struct CallListener {
  std::function<void(const std::string& method)> on_start;
  std::function<void(const std::string& method, int status, double seconds)> on_end;
};

struct GrpcServerOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT or unix:PATH; port 0 takes any free one
  // PEM texts; certificate and key come together. With client_ca, clients must show a certificate
  // that it has signed.
  std::string tls_certificate{}, tls_key{}, tls_client_ca{};
  // Computes poses. The service shares it for its own work on poses, so that all of them take
  // turns. Null makes the server start its own threads, one per core. It must outlive the server.
  Executor* pose_executor = nullptr;
  const CallListener* call_listener = nullptr;  // must outlive the server; may be null
  int num_storage_threads = 4;  // for the disk, the catalog and the checks of uploads
  // The largest message; 20,000 poses of 18 joints are 14 MB. All messages that are under way share
  // 1 GiB.
  int max_receive_bytes = 16 << 20;
  // For the poses of clips, all calls together. A parsed pose takes three times what it takes on
  // the wire.
  uint64_t request_bytes = uint64_t{512} << 20;
  ConnectionLimits connections{};
  int max_streams_per_connection = 128;
  int max_open_streams = 256;  // uploads, watches, clips, live sessions, downloads
};

class GrpcServer {
 public:
  // Serves `service`, which must outlive the server. kUnavailable when the address cannot be bound
  // or the certificate does not fit its key, kInvalidArgument when one of the two is missing.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> Start(CharacterService* service,
                                                           const GrpcServerOptions& options);
  virtual ~GrpcServer() = default;  // calls Shutdown(0)

  virtual int port() const = 0;  // 0 for an address without a port
  virtual int num_connections() const = 0;
  virtual uint64_t num_refused_connections() const = 0;
  // A channel that needs no network, for tests and embedding.
  virtual std::shared_ptr<grpc::Channel> InProcessChannel() = 0;
  // Refuses new calls with kUnavailable, lets running ones go on for up to `drain_seconds`, then
  // cancels what is left. Live sessions end at once with kUnavailable, so that their clients can
  // go on elsewhere; one whose client does not read is given up after a second. Returns when no
  // call is left.
  virtual void Shutdown(double drain_seconds) = 0;
};

}  // namespace pleat
