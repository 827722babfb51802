#include "connection_listener.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kOtherDescriptors = 256;  // the catalog, stored files, logs, gRPC itself
constexpr int kReportMs = 1000;
constexpr int kMaxAcceptsPerTurn = 256;

double SteadySecondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The address of a peer without its port.
std::string PeerName(const sockaddr_storage& address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(&address)->sin_addr, text,
              sizeof text);
  } else if (address.ss_family == AF_INET6) {
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(&address)->sin6_addr, text,
              sizeof text);
  } else {
    return "this machine";
  }
  return text;
}

bool AddToEpoll(int epoll, int fd, uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.fd = fd;
  return epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ConnectionListener>> ConnectionListener::Open(
    const std::string& address, ConnectionLimits limits) {
  PLEAT_ASSIGN_OR_RETURN(ListeningSocket socket, ListeningSocket::Open(address));
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) == 0) {
    const auto room = static_cast<int64_t>(std::min<rlim_t>(descriptors.rlim_cur, 1 << 24));
    const int64_t most = std::max<int64_t>(1, (room - kOtherDescriptors) / 2);
    limits.max_connections = static_cast<int>(std::min<int64_t>(limits.max_connections, most));
  }
  std::unique_ptr<ConnectionListener> listener(new ConnectionListener(std::move(socket), limits));
  if (listener->epoll_ < 0 || listener->wake_ < 0 || listener->reserve_ < 0 ||
      !AddToEpoll(listener->epoll_, listener->socket_.fd(), EPOLLIN) ||
      !AddToEpoll(listener->epoll_, listener->wake_, EPOLLIN)) {
    return absl::UnavailableError(
        absl::StrCat("cannot listen on '", address, "': no file descriptors are left"));
  }
  return listener;
}

ConnectionListener::ConnectionListener(ListeningSocket socket, ConnectionLimits limits)
    : socket_(std::move(socket)),
      limits_(limits),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      reserve_(open("/dev/null", O_RDONLY | O_CLOEXEC)) {}

void ConnectionListener::Stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  const uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof one);
  thread_.join();
  socket_.Close();
}

ConnectionListener::~ConnectionListener() {
  Stop();
  for (const auto& [watcher, peer] : watchers_) close(watcher);
  for (const int fd : {epoll_, wake_, reserve_}) {
    if (fd >= 0) close(fd);
  }
}

void ConnectionListener::Start(HandOver hand_over, OnRefused on_refused) {
  hand_over_ = std::move(hand_over);
  on_refused_ = std::move(on_refused);
  thread_ = std::thread([this] { Run(); });
}

void ConnectionListener::Run() {
  std::array<epoll_event, 256> events;
  while (!stopping_) {
    const bool reports_are_due = num_refused() > num_reported_;
    const int count = epoll_wait(epoll_, events.data(), static_cast<int>(events.size()),
                                 reports_are_due ? kReportMs : -1);
    bool accept = false;
    for (int i = 0; i < count; ++i) {
      const int fd = events[static_cast<size_t>(i)].data.fd;
      if (fd == socket_.fd()) {
        accept = true;  // after those that end, which make room
      } else if (fd != wake_) {
        Forget(fd);
      }
    }
    if (accept) AcceptAll();
    ReportRefusals();
  }
}

void ConnectionListener::AcceptAll() {
  for (int i = 0; i < kMaxAcceptsPerTurn; ++i) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    const int fd = accept4(socket_.fd(), reinterpret_cast<sockaddr*>(&address), &size,
                           SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) {
      if (errno == EMFILE || errno == ENFILE) {
        CloseOneWithTheReserve();
        continue;
      }
      if (errno == EINTR || errno == ECONNABORTED) continue;
      return;  // EAGAIN: nobody waits any more
    }
    const std::string peer = PeerName(address);
    const char* refusal = Refusal(peer);
    if (refusal == nullptr && !Watch(fd, peer)) refusal = "no file descriptors are left";
    if (refusal != nullptr) {
      NoteRefusal(peer, refusal);
      close(fd);
      continue;
    }
    // A frame is one message; waiting for more to send would cost milliseconds.
    const int yes = 1;
    if (address.ss_family != AF_UNIX) setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    hand_over_(fd);
  }
}

const char* ConnectionListener::Refusal(const std::string& peer) const {
  if (num_open() >= limits_.max_connections) return "the server has its most connections";
  const auto it = num_by_peer_.find(peer);
  if (it != num_by_peer_.end() && it->second >= limits_.max_connections_per_peer) {
    return "the peer has its most connections";
  }
  return nullptr;
}

// Whoever owns the connection shuts it down in the end, before it closes its descriptor; so does
// the peer. Both can be seen at any descriptor of the socket.
bool ConnectionListener::Watch(int fd, const std::string& peer) {
  const int watcher = fcntl(fd, F_DUPFD_CLOEXEC, 0);
  if (watcher < 0) return false;
  if (!AddToEpoll(epoll_, watcher, EPOLLRDHUP)) {  // and EPOLLHUP, which always comes
    close(watcher);
    return false;
  }
  watchers_.emplace(watcher, peer);
  ++num_by_peer_[peer];
  ++num_open_;
  return true;
}

void ConnectionListener::Forget(int watcher) {
  const auto it = watchers_.find(watcher);
  if (it == watchers_.end()) return;
  if (const auto peer = num_by_peer_.find(it->second); --peer->second == 0) {
    num_by_peer_.erase(peer);
  }
  watchers_.erase(it);
  close(watcher);  // which takes it out of the epoll set
  --num_open_;
}

void ConnectionListener::CloseOneWithTheReserve() {
  if (reserve_ >= 0) close(reserve_);
  const int fd = accept(socket_.fd(), nullptr, nullptr);
  NoteRefusal("somebody", "no file descriptors are left");
  if (fd >= 0) close(fd);
  reserve_ = open("/dev/null", O_RDONLY | O_CLOEXEC);
}

void ConnectionListener::NoteRefusal(const std::string& peer, const char* why) {
  ++num_refused_;
  last_refusal_ = absl::StrCat(peer, ": ", why);
}

void ConnectionListener::ReportRefusals() {
  if (num_refused() == num_reported_) return;
  const double now = SteadySecondsNow();
  if (last_report_seconds_ >= 0 && now - last_report_seconds_ < kReportMs / 1000.) return;
  last_report_seconds_ = now;
  on_refused_(absl::StrCat(num_refused() - num_reported_, " connections refused, the last from ",
                           last_refusal_));
  num_reported_ = num_refused();
}

}  // namespace pleat
