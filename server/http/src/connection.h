// One connection of HTTP/1.1. Included by http_server.cpp alone, so that Beast is compiled once.
#pragma once

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http.hpp>
#include <cerrno>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/http/http_server.h"
#include "socket_run.h"

namespace pleat {

namespace http = beast::http;
using asio::ip::tcp;
using Parser = http::request_parser<http::buffer_body>;

inline constexpr size_t kPieceBytes = 64 << 10;

inline std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(1e3 * seconds));
}

inline std::string PeerName(const tcp::endpoint& endpoint) {
  const bool is_v6 = endpoint.address().is_v6();
  return absl::StrCat(is_v6 ? "ipv6:[" : "ipv4:", endpoint.address().to_string(),
                      is_v6 ? "]:" : ":", endpoint.port());
}

inline HttpRequest HeadOf(const Parser& parser, const std::string& peer) {
  HttpRequest head;
  head.method = std::string(parser.get().method_string());
  head.target = std::string(parser.get().target());
  head.peer = peer;
  for (const auto& field : parser.get()) {
    head.headers[absl::AsciiStrToLower(std::string(field.name_string()))] =
        std::string(field.value());
  }
  return head;
}

// One connection and its thread. Each step has a deadline: a client that is slow, or gone, does not
// keep the thread.
class Connection {
 public:
  Connection(const HttpServerOptions& options, HttpHandler* handler)
      : options_(options), handler_(handler) {}
  ~Connection() {
    if (thread_.joinable()) thread_.join();
  }

  asio::io_context& io() { return io_; }
  void Start(tcp::socket socket) {
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    peer_ = PeerName(socket.remote_endpoint(ignored));
    stream_.emplace(std::move(socket));
    thread_ = std::thread([this] {
      Serve();
      done_ = true;
    });
  }
  bool done() const { return done_; }
  // From another thread: what is under way ends.
  void Stop() {
    stopping_ = true;
    asio::post(io_, [this] {
      if (run_ != nullptr) return run_->End();
      if (stream_) stream_->close();
    });
  }

 private:
  // Runs one operation to its end on this thread.
  template <typename Operation>
  error_code Await(double seconds, Operation operation) {
    error_code result;
    stream_->expires_after(Milliseconds(seconds));
    operation([&result](error_code error, size_t) { result = error; });
    io_.restart();
    io_.run();
    return stopping_ ? error_code(asio::error::operation_aborted) : result;
  }

  void Serve() {
    try {
      while (!stopping_ && ServeOne()) {
      }
    } catch (const std::exception& error) {
      spdlog::warn("http: a connection ended by {}", error.what());
    }
    if (!stream_) return;  // a WebSocket has taken and closed it
    error_code ignored;
    stream_->socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_->close();
  }

  // False: the connection ends.
  bool ServeOne() {
    Parser parser;
    parser.header_limit(static_cast<uint32_t>(options_.max_header_bytes));
    parser.body_limit(options_.max_body_bytes);
    const error_code error = Await(options_.idle_seconds, [&](auto done) {
      http::async_read_header(*stream_, buffer_, parser, std::move(done));
    });
    if (error == http::error::body_limit) {
      return Refuse(parser, RefuseForLimit({.limit = "--max-upload-bytes"},
                                           "the body is larger than any upload may be"));
    }
    if (error == http::error::header_limit) {
      return Refuse(parser, absl::InvalidArgumentError("the header of the request is too large"));
    }
    if (error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message) {
      return Refuse(parser, absl::InvalidArgumentError(
                                absl::StrCat("not a request of HTTP/1.1: ", error.message())));
    }
    if (error) return false;
    HttpRequest request = HeadOf(parser, peer_);
    if (websocket::is_upgrade(parser.get())) return ServeSocket(parser, request);
    absl::StatusOr<BodyPlan> plan = handler_->PlanBody(request);
    if (!plan.ok()) return Refuse(parser, plan.status());
    const absl::Status read = ReadBody(parser, *plan, &request);
    if (!read.ok()) return Refuse(parser, read);
    return Write(handler_->Handle(request), parser.keep_alive(), request.method == "HEAD");
  }

  absl::Status ReadBody(Parser& parser, const BodyPlan& plan, HttpRequest* request) {
    request->sink = plan.sink;
    const auto length = parser.content_length();
    if (length && *length > plan.max_bytes) return TooLarge(plan.max_bytes);
    if (parser.is_done()) return absl::OkStatus();
    if (absl::EqualsIgnoreCase(request->Header("expect"), "100-continue")) {
      http::response<http::empty_body> go_on(http::status::continue_, 11);
      if (Await(options_.step_seconds,
                [&](auto done) { http::async_write(*stream_, go_on, std::move(done)); })) {
        return absl::UnavailableError("the client is gone");
      }
    }
    uint64_t size = 0;
    piece_.resize(kPieceBytes);
    while (!parser.is_done()) {
      parser.get().body().data = piece_.data();
      parser.get().body().size = piece_.size();
      const error_code error = Await(options_.step_seconds, [&](auto done) {
        // What has arrived, so that a body that is too large is refused before its end.
        http::async_read_some(*stream_, buffer_, parser, std::move(done));
      });
      if (error && error != http::error::need_buffer) {
        return absl::InvalidArgumentError(absl::StrCat("the body is cut off: ", error.message()));
      }
      const std::string_view piece(piece_.data(), piece_.size() - parser.get().body().size);
      size += piece.size();
      if (size > plan.max_bytes) return TooLarge(plan.max_bytes);
      if (plan.sink == nullptr) {
        request->body.append(piece);
      } else if (absl::Status status = plan.sink->Append(piece); !status.ok()) {
        return status;
      }
    }
    return absl::OkStatus();
  }

  static absl::Status TooLarge(uint64_t max_bytes) {
    return RefuseForLimit({.limit = "body"},
                          absl::StrCat("the body has more than ", max_bytes, " bytes"));
  }

  // The rest of the request is not read, so the connection ends.
  bool Refuse(const Parser&, const absl::Status& status) {
    Write(ErrorResponse(status), /*keep_alive=*/false, /*is_head=*/false);
    return false;
  }

  bool Write(HttpResponse&& response, bool keep_alive, bool is_head) {
    http::response<http::buffer_body> message(static_cast<http::status>(response.status), 11);
    for (const auto& [name, value] : response.headers) message.set(name, value);
    message.keep_alive(keep_alive);
    const std::string_view body =
        response.lasting_body.empty() ? response.body : response.lasting_body;
    if (response.next) {
      message.chunked(true);
    } else {
      message.content_length(body.size());
    }
    const bool has_body = !is_head && (response.next || !body.empty());
    message.body().data = has_body && !response.next ? const_cast<char*>(body.data()) : nullptr;
    message.body().size = has_body && !response.next ? body.size() : 0;
    message.body().more = has_body && static_cast<bool>(response.next);
    http::response_serializer<http::buffer_body> serializer(message);
    if (is_head || response.next) {
      if (WriteSome([&](auto done) {
            http::async_write_header(*stream_, serializer, std::move(done));
          })) {
        return false;
      }
      if (is_head) return keep_alive;
      return WritePieces(response, message, serializer) && keep_alive;
    }
    return !WriteSome([&](auto done) {
      http::async_write(*stream_, serializer, std::move(done));
    }) && keep_alive;
  }

  template <typename Operation>
  error_code WriteSome(Operation operation) {
    const error_code error = Await(options_.step_seconds, std::move(operation));
    return error == http::error::need_buffer ? error_code() : error;
  }

  bool WritePieces(const HttpResponse& response, http::response<http::buffer_body>& message,
                   http::response_serializer<http::buffer_body>& serializer) {
    std::string piece;
    for (bool more = true; more;) {
      piece.clear();
      const absl::StatusOr<bool> next = response.next(&piece);
      if (!next.ok() || stopping_) return false;
      more = *next;
      if (piece.empty() && more) {
        if (ClientIsGone()) return false;
        continue;
      }
      message.body().data = piece.empty() ? nullptr : piece.data();
      message.body().size = piece.size();
      message.body().more = more;
      if (WriteSome([&](auto done) { http::async_write(*stream_, serializer, std::move(done)); })) {
        return false;
      }
    }
    return true;
  }

  // Looks without waiting: a client that waits for a response has nothing to say.
  bool ClientIsGone() {
    char byte = 0;
    const ssize_t count =
        recv(stream_->socket().native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
  }

  bool ServeSocket(Parser& parser, const HttpRequest& head) {
    absl::StatusOr<std::unique_ptr<WebSocketSession>> session = handler_->OpenWebSocket(head);
    if (!session.ok()) return Refuse(parser, session.status());
    stream_->expires_never();
    Socket socket(std::move(*stream_));
    stream_.reset();
    socket.read_message_max(options_.max_socket_message_bytes);
    websocket::stream_base::timeout timeout{Milliseconds(options_.step_seconds),
                                            Milliseconds(options_.step_seconds), true};
    socket.set_option(timeout);
    http::request<http::empty_body> upgrade;
    upgrade.base() = parser.get().base();
    error_code accepted;
    socket.async_accept(upgrade, [&](error_code error) { accepted = error; });
    io_.restart();
    io_.run();
    if (!accepted && !stopping_) {
      socket.binary(true);
      SocketRun run(&io_, &socket, session->get());
      run_ = &run;
      if (stopping_) run.End();
      run.Run();
      run_ = nullptr;
    }
    return false;
  }

  const HttpServerOptions& options_;
  HttpHandler* const handler_;
  asio::io_context io_{1};
  std::optional<beast::tcp_stream> stream_;
  std::string peer_;
  beast::flat_buffer buffer_;
  std::string piece_;
  SocketRun* run_ = nullptr;  // of this thread
  std::atomic<bool> stopping_ = false, done_ = false;
  std::thread thread_;
};

}  // namespace pleat
