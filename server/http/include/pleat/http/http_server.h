// An HTTP/1.1 server with WebSockets over Boost.Beast. One thread serves one connection, so a
// handler may block; their number is bounded.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/http/http_message.h"

namespace pleat {

struct HttpServerOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT with a numeric host; port 0 takes any free one
  // Hears the address, with the port that was taken, before the first request comes. May be empty.
  std::function<void(const std::string& address)> on_bound{};
  int max_connections = 256;
  double idle_seconds = 75;  // a connection without a request is closed after this
  double step_seconds = 30;  // a header, a piece of a body, a write
  uint64_t max_header_bytes = 16 << 10;
  uint64_t max_body_bytes = uint64_t{4} << 30;    // above what any handler plans
  uint64_t max_socket_message_bytes = 256 << 10;  // of a WebSocket, from the client
};

class HttpServer {
 public:
  // `handler` must outlive the server. kUnavailable when the address cannot be bound.
  static absl::StatusOr<std::unique_ptr<HttpServer>> Start(HttpServerOptions options,
                                                           HttpHandler* handler);
  virtual ~HttpServer() = default;  // calls Shutdown

  virtual std::string address() const = 0;  // HOST:PORT, with the port that was taken
  // Closes all connections and returns when no handler runs.
  virtual void Shutdown() = 0;
};

}  // namespace pleat
