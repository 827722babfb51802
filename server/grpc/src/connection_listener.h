// Accepts connections, so that a flood of them ends when it ends.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "listening_socket.h"
#include "pleat/grpc/grpc_server.h"

namespace pleat {

// gRPC 1.51 stops listening for ever when the process has no file descriptor left. So this class
// accepts in its place and hands the sockets over. What is beyond the limits is closed at once, and
// when there is no descriptor the last, which is held in reserve, is given up to accept and close
// what waits. A watcher's descriptor of every connection tells when it ends: each connection takes
// two descriptors.
class ConnectionListener {
 public:
  // Takes over a connected socket. Called from the listener's thread.
  using HandOver = std::function<void(int fd)>;
  // Receives one sentence about connections that were refused, at most once a second.
  using OnRefused = std::function<void(const std::string& what)>;

  // Errors of ListeningSocket::Open. The descriptors that the process may have bound the limits.
  static absl::StatusOr<std::unique_ptr<ConnectionListener>> Open(const std::string& address,
                                                                  ConnectionLimits limits);
  ~ConnectionListener();  // calls Stop

  // Stops accepting; connections that were handed over go on.
  void Stop();
  void Start(HandOver hand_over, OnRefused on_refused);
  int port() const { return socket_.port(); }
  int num_open() const { return num_open_.load(std::memory_order_relaxed); }
  uint64_t num_refused() const { return num_refused_.load(std::memory_order_relaxed); }

 private:
  ConnectionListener(ListeningSocket socket, ConnectionLimits limits);
  void Run();
  void AcceptAll();
  // Returns why the connection is refused, null when it is not.
  const char* Refusal(const std::string& peer) const;
  bool Watch(int fd, const std::string& peer);
  void Forget(int watcher);
  void CloseOneWithTheReserve();
  void NoteRefusal(const std::string& peer, const char* why);
  void ReportRefusals();

  ListeningSocket socket_;
  ConnectionLimits limits_;
  int epoll_ = -1, wake_ = -1, reserve_ = -1;
  HandOver hand_over_;
  OnRefused on_refused_;
  std::thread thread_;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> num_open_ = 0;
  std::atomic<uint64_t> num_refused_ = 0;

  // The listener's thread alone uses what follows.
  std::map<int, std::string> watchers_;     // the peers of open connections, by the watcher's fd
  std::map<std::string, int> num_by_peer_;  // open connections
  uint64_t num_reported_ = 0;
  double last_report_seconds_ = -1;
  std::string last_refusal_;
};

}  // namespace pleat
