// Plain TCP clients, for tests of what stands before gRPC.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <utility>

namespace pleat {

class TcpClient {
 public:
  // Connects from the address `from` to 127.0.0.1:port; ok() says whether that worked.
  explicit TcpClient(int port, const std::string& from = "127.0.0.1")
      : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, from.c_str(), &address.sin_addr);
    ok_ = fd_ >= 0 && bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    address.sin_port = htons(static_cast<uint16_t>(port));
    ok_ = ok_ && connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~TcpClient() { Close(); }
  TcpClient(TcpClient&& other) noexcept : fd_(std::exchange(other.fd_, -1)), ok_(other.ok_) {}
  TcpClient& operator=(TcpClient&&) = delete;

  bool ok() const { return ok_; }
  int fd() const { return fd_; }
  // Waits until the other side has closed the connection; false when it sends something instead.
  bool WaitForEnd() {
    char byte = 0;
    return recv(fd_, &byte, 1, 0) <= 0;
  }
  void Close() {
    if (fd_ >= 0) close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
  bool ok_ = false;
};

}  // namespace pleat
