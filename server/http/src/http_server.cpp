#include "pleat/http/http_server.h"

#include <spdlog/spdlog.h>

#include <boost/asio/steady_timer.hpp>
#include <list>
#include <thread>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "connection.h"
#include "pleat/base/address.h"

namespace pleat {
namespace {

constexpr auto kPause = std::chrono::milliseconds(100);

class BeastServer final : public HttpServer {
 public:
  BeastServer(HttpServerOptions options, HttpHandler* handler)
      : options_(std::move(options)), handler_(handler) {}
  ~BeastServer() override { Shutdown(); }

  absl::Status Bind() {
    const size_t colon = options_.listen.rfind(':');
    uint32_t port = 0;
    error_code error;
    if (colon == std::string::npos || !absl::SimpleAtoi(options_.listen.substr(colon + 1), &port) ||
        port > 65535) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", options_.listen, "' is no HOST:PORT to serve pages at"));
    }
    std::string host(HostOf(options_.listen));
    if (host == "localhost") host = "127.0.0.1";
    const tcp::endpoint endpoint(asio::ip::make_address(host, error), static_cast<uint16_t>(port));
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      return absl::UnavailableError(
          absl::StrCat("cannot serve pages at ", options_.listen, ": ", error.message()));
    }
    address_ =
        absl::StrCat(options_.listen.substr(0, colon), ":", acceptor_.local_endpoint().port());
    if (options_.on_bound) options_.on_bound(address_);
    Accept();
    thread_ = std::thread([this] { io_.run(); });
    return absl::OkStatus();
  }

  std::string address() const override { return address_; }

  void Shutdown() override {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] {
      acceptor_.close();
      pause_.cancel();
    });
    thread_.join();
    for (const auto& connection : connections_) connection->Stop();
    connections_.clear();
  }

 private:
  void Accept() {
    if (!acceptor_.is_open()) return;
    connections_.remove_if([](const auto& connection) { return connection->done(); });
    next_ = std::make_unique<Connection>(options_, handler_);
    acceptor_.async_accept(next_->io(), [this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted || !acceptor_.is_open()) return;
      if (!error && connections_.size() < static_cast<size_t>(options_.max_connections)) {
        next_->Start(std::move(socket));
        connections_.push_back(std::move(next_));
      } else if (!error) {
        spdlog::warn("http: a connection is refused, {} are open", connections_.size());
        socket.close(error);
      } else {  // no file descriptor is left: others must end first
        spdlog::warn("http: cannot accept: {}", error.message());
        pause_.expires_after(kPause);
        pause_.async_wait([this](error_code) { Accept(); });
        return;
      }
      Accept();
    });
  }

  const HttpServerOptions options_;
  HttpHandler* const handler_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};
  std::unique_ptr<Connection> next_;
  std::list<std::unique_ptr<Connection>> connections_;  // of the thread that accepts
  std::string address_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<HttpServer>> HttpServer::Start(HttpServerOptions options,
                                                              HttpHandler* handler) {
  auto server = std::make_unique<BeastServer>(std::move(options), handler);
  if (absl::Status status = server->Bind(); !status.ok()) return status;
  return server;
}

}  // namespace pleat
