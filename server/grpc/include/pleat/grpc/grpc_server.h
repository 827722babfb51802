// The network side of the server.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/executor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/grpc/call_gateway.h"
#include "pleat/identity/token_registry.h"
#include "pleat/service/character_service.h"

namespace grpc {
class Channel;
}

namespace pleat {

struct ConnectionLimits {
  int max_connections = 4096;           // fewer where the process may have too few file descriptors
  int max_connections_per_peer = 1024;  // with one address
  double max_idle_seconds = 600;        // a connection without calls is closed after this
  // A connection that is older takes no more calls, so that clients come back elsewhere after a
  // change of servers; its calls may go on for the grace time and are cancelled then. 0: for ever.
  double max_age_seconds = 0;
  double max_age_grace_seconds = 60;
};

// What is known of a call when it has ended.
struct CallFacts {
  std::string method;    // "/pleat.v1.ModelService/DeleteModel"
  std::string peer;      // as gRPC writes it: "ipv4:10.0.0.7:52114"
  std::string token_id;  // of the token that it showed, good or not; empty: none
  std::string trace_id;  // of the W3C trace that it belongs to, 32 digits; empty: none
  // What all log lines about the call name: "x-request-id" of its metadata, or made by the server.
  std::string request_id;
  std::string project;  // that the call was let into; empty: none
  std::string limit;    // that refused the call (google.rpc.QuotaFailure); empty: none did
  bool is_stream = false;
  bool audited = false;          // it belongs in the audit log, whatever its end
  std::vector<std::string> ids;  // that its request names; only of audited calls
};

// Hears of every call, from any thread. status: a grpc::StatusCode.
struct CallListener {
  std::function<void(const std::string& method)> on_start;
  std::function<void(const CallFacts& facts, int status, double seconds)> on_end;
  // How long a step of a frame took: "query", "encode" or "send". May be empty.
  std::function<void(const char* step, double seconds)> on_frame_step{};
};

// PEM files. Certificate and key come together; with client_ca, clients must show a certificate
// that it has signed. A file that is replaced is used for the connections that begin some seconds
// later; replace certificate and key together, by renaming their folder.
struct TlsFiles {
  std::string certificate{}, key{}, client_ca{};
  unsigned reload_seconds = 10;  // between two looks at the files
};

// The services of a project, which live as long as the server. Called from any thread.
using ServicesOfProject = std::function<CharacterService*(const std::string& project)>;

struct GrpcServerOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT or unix:PATH; port 0 takes any free one
  TlsFiles tls{};                      // without a certificate: plain text
  // Computes poses. The service shares it for its own work on poses, so that all of them take
  // turns. Null makes the server start its own threads, one per core. It must outlive the server.
  Executor* pose_executor = nullptr;
  const CallListener* call_listener = nullptr;  // must outlive the server; may be null
  // Says who may call what; it must outlive the server. Null: everybody may do everything. Calls of
  // a token that is revoked or expires end within a second.
  TokenRegistry* tokens = nullptr;
  // What the token of a project sees. Empty: every token sees the service of Start, as all callers
  // without a token do.
  ServicesOfProject of_project{};
  // Says why nothing can be stored at the moment; asked every two seconds, for the health service.
  // Null: nobody asks.
  std::function<absl::Status()> probe{};
  int num_storage_threads = 2;   // for answers out of the catalog
  int num_transfer_threads = 4;  // for uploads with their checks, downloads and decoding
  // The largest message; 20,000 poses of 18 joints are 14 MB.
  int max_receive_bytes = 16 << 20;
  // For requests and their answers while they are worked on, all calls together; most of it goes to
  // the poses of clips. A parsed pose takes three times what it takes on the wire.
  uint64_t request_bytes = uint64_t{512} << 20;
  // What the memory of requests, streams and messages is a part of; it must outlive the server.
  // Null: nothing else counts.
  MemoryBudget* memory = nullptr;
  ConnectionLimits connections{};
  int max_streams_per_connection = 128;
  int max_open_streams = 1024;  // uploads, watches, clips, live sessions, downloads
  // The same for one token, or for one address of callers without tokens: one client cannot have
  // all streams.
  int max_streams_per_client = 256;
};

// What a caller that was let in may use; it lives as long as the server.
struct AdmittedServices {
  ModelService* models = nullptr;
  PoseService* poses = nullptr;
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
  // The Unix second at which the certificate that is on the disk now expires; nothing without TLS,
  // or while the file cannot be read.
  virtual std::optional<int64_t> certificate_expiry() const = 0;
  virtual uint64_t num_refused_connections() const = 0;
  // What is reserved now for requests, for streams, and for gRPC itself with its connections.
  struct MemoryUse {
    uint64_t requests = 0, streams = 0, messages = 0;
  };
  virtual MemoryUse memory_use() const = 0;
  // The way in for calls that come from elsewhere, such as from browsers.
  virtual CallGateway& gateway() = 0;
  // The services that a caller sees, for work that is no RPC but needs the same permission as
  // `rpc`. The errors are those of Admit (admission.h).
  virtual absl::StatusOr<AdmittedServices> Admit(const ForeignCaller& caller, const char* rpc) = 0;
  // A channel that needs no network, for tests and embedding.
  virtual std::shared_ptr<grpc::Channel> InProcessChannel() = 0;
  // Refuses new calls with kUnavailable, lets running ones go on for up to `drain_seconds`, then
  // cancels what is left. Live sessions end at once with kUnavailable, so that their clients can
  // go on elsewhere; one whose client does not read is given up after a second. Returns when no
  // call is left.
  virtual void Shutdown(double drain_seconds) = 0;
};

}  // namespace pleat
