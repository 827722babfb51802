#include "listening_socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr char kUnixPrefix[] = "unix:";
constexpr int kBacklog = 512;  // connections that wait to be accepted

absl::Status CannotListen(const std::string& address, const std::string& why) {
  return absl::UnavailableError(absl::StrCat("cannot listen on '", address, "': ", why));
}

// Binds and listens; -1 with errno set.
int Listen(int family, const sockaddr* address, socklen_t size) {
  const int fd = socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  const int yes = 1, no = 0;
  // A restart need not wait for old connections to time out. This lets no second server in.
  if (family != AF_UNIX) setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (family == AF_INET6) setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no);
  if (bind(fd, address, size) == 0 && listen(fd, kBacklog) == 0) return fd;
  const int error = errno;
  close(fd);
  errno = error;
  return -1;
}

int PortOf(int fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port
                   : reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
}

}  // namespace

absl::StatusOr<ListeningSocket> ListeningSocket::Open(const std::string& address) {
  if (address.starts_with(kUnixPrefix)) {
    std::string path = address.substr(sizeof(kUnixPrefix) - 1);
    sockaddr_un name{};
    if (path.empty() || path.size() >= sizeof name.sun_path) {
      return absl::InvalidArgumentError(absl::StrCat("'", address,
                                                     "': the path of a socket has 1 to ",
                                                     sizeof name.sun_path - 1, " characters"));
    }
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path.data(), path.size());
    const int fd = Listen(AF_UNIX, reinterpret_cast<const sockaddr*>(&name), sizeof name);
    if (fd < 0) return CannotListen(address, std::strerror(errno));
    return ListeningSocket(fd, 0, std::move(path));
  }
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon + 1 == address.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", address, "' is no address to listen on: write HOST:PORT or unix:PATH"));
  }
  int port = 0;
  if (!absl::SimpleAtoi(address.substr(colon + 1), &port) || port < 0 || port > 65535) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", address, "' is no address to listen on: the port is a number from 0 to 65535"));
  }
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.empty() ? nullptr : host.c_str(), address.c_str() + colon + 1,
                                &hints, &found);
  if (error != 0) return CannotListen(address, gai_strerror(error));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    const int fd = Listen(one->ai_family, one->ai_addr, one->ai_addrlen);
    if (fd >= 0) return ListeningSocket(fd, PortOf(fd), "");
  }
  return CannotListen(address, std::strerror(errno));
}

void ListeningSocket::Close() {
  if (fd_ < 0) return;
  close(std::exchange(fd_, -1));
  if (!unix_path_.empty()) unlink(unix_path_.c_str());
}

}  // namespace pleat
