// A socket that listens at an address of the command line.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace pleat {

class ListeningSocket {
 public:
  // address: HOST:PORT, [IPV6]:PORT or unix:PATH. kInvalidArgument when it is none of them,
  // kUnavailable when it cannot be bound. Nobody else can listen at the same address and port.
  static absl::StatusOr<ListeningSocket> Open(const std::string& address);
  ~ListeningSocket() { Close(); }
  void Close();  // gives the address back
  ListeningSocket(ListeningSocket&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)),
        port_(other.port_),
        unix_path_(std::exchange(other.unix_path_, "")) {}
  ListeningSocket& operator=(ListeningSocket&&) = delete;

  int fd() const { return fd_; }
  int port() const { return port_; }  // 0 of a unix socket

 private:
  ListeningSocket(int fd, int port, std::string unix_path)
      : fd_(fd), port_(port), unix_path_(std::move(unix_path)) {}

  int fd_;
  int port_;
  std::string unix_path_;  // is removed in the end; empty of an internet address
};

}  // namespace pleat
