// The network side of the server.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/executor.h"
#include "pleat/service/character_service.h"

namespace grpc {
class Channel;
}

namespace pleat {

struct GrpcServerOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT, unix:PATH; port 0 = any free one
  // PEM texts; both or none. With client_ca, clients must show a certificate that it signed.
  std::string tls_certificate{}, tls_key{}, tls_client_ca{};
  // Where poses are computed, shared with the service's own work on poses so that all take turns;
  // null: threads of the server, one per core. Must outlive the server.
  Executor* pose_executor = nullptr;
  int num_storage_threads = 4;  // disk, catalogue, checking uploads
  // Of one message; 20,000 poses of 18 joints are 14 MB. All that are under way share 1 GiB.
  int max_receive_bytes = 16 << 20;
  int max_streams_per_connection = 128;
  int max_open_streams = 256;  // uploads, watches, clips, live sessions, downloads
};

class GrpcServer {
 public:
  // Serves `service`, which must outlive the server. kUnavailable when the address cannot be bound,
  // kInvalidArgument for certificates that do not fit.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> Start(CharacterService* service,
                                                           const GrpcServerOptions& options);
  virtual ~GrpcServer() = default;  // Shutdown(0)

  virtual int port() const = 0;  // 0 for addresses without port
  // A channel without network, for tests and embedding.
  virtual std::shared_ptr<grpc::Channel> InProcessChannel() = 0;
  // Refuses new calls with kUnavailable, lets running ones go on for up to `drain_seconds`, then
  // cancels what is left. Live sessions end at once with kUnavailable, so that their clients can
  // go on elsewhere.
  virtual void Shutdown(double drain_seconds) = 0;
};

}  // namespace pleat
