// Requests and responses of HTTP/1.1, without saying who parses them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// Where the body of a request goes while it arrives.
class BodySink {
 public:
  virtual ~BodySink() = default;
  virtual absl::Status Append(std::string_view bytes) = 0;
};

struct HttpRequest {
  std::string method{};                          // "GET"
  std::string target{};                          // "/path?query" as it was sent
  std::map<std::string, std::string> headers{};  // lower-case names; of several the last one
  std::string peer{};                            // "ipv4:127.0.0.1:40112"
  std::string body{};                            // empty when a sink has taken it
  std::shared_ptr<BodySink> sink{};

  // Empty when there is none.
  const std::string& Header(const std::string& name) const {
    static const std::string& none = *new std::string;
    const auto found = headers.find(name);
    return found == headers.end() ? none : found->second;
  }
};

// What of a body is taken: so many bytes, into the sink or, without one, into HttpRequest::body.
struct BodyPlan {
  uint64_t max_bytes = 0;
  std::shared_ptr<BodySink> sink{};
};

struct HttpResponse {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string body{};
  std::string_view lasting_body{};  // in place of `body`: bytes that live as long as the program
  // In place of both: pieces until it gives false. An error cuts the response off, so that the
  // client sees that it is not whole. An empty piece is not sent, but the connection is looked at.
  std::function<absl::StatusOr<bool>(std::string* piece)> next{};
};

// What a handler does with one WebSocket. Thread-safe; nothing has an effect after the end.
class WebSocketSink {
 public:
  virtual ~WebSocketSink() = default;
  virtual void Send(std::string bytes, bool is_text) = 0;  // the next one after OnSent
  virtual void ReadNext() = 0;                             // the next one after OnMessage
  // Sends what waits and says goodbye. code: of RFC 6455, section 7.4.
  virtual void Close(uint16_t code) = 0;
};

// One WebSocket as its handler sees it. All functions run on the thread of its connection.
class WebSocketSession {
 public:
  virtual ~WebSocketSession() = default;
  virtual void OnOpen(std::shared_ptr<WebSocketSink> sink) = 0;
  virtual void OnMessage(std::string bytes, bool is_text) = 0;
  virtual void OnSent() = 0;
  virtual void OnEnd() = 0;  // the last
};

// Answers requests, each on the thread of its connection, so it may block. Thread-safe.
class HttpHandler {
 public:
  virtual ~HttpHandler() = default;
  // Called before the body is read; an error is the answer (ErrorResponse).
  virtual absl::StatusOr<BodyPlan> PlanBody(const HttpRequest& head) = 0;
  virtual HttpResponse Handle(const HttpRequest& request) = 0;
  // An error refuses the upgrade.
  virtual absl::StatusOr<std::unique_ptr<WebSocketSession>> OpenWebSocket(
      const HttpRequest& head) = 0;
};

// The status code of HTTP that says the same.
int HttpStatusOf(const absl::Status& status);
// {"code": "NOT_FOUND", "message": "..."} with that status code.
HttpResponse ErrorResponse(const absl::Status& status);
HttpResponse JsonResponse(std::string json);

}  // namespace pleat
