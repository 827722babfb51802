#include "connection_listener.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/grpc/sockets.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Owns the connections as gRPC does: it shuts them down before it closes them.
class Owner {
 public:
  ~Owner() {
    for (const int fd : fds_) close(fd);
  }
  ConnectionListener::HandOver hand_over() {
    return [this](int fd) {
      std::lock_guard lock(mutex_);
      fds_.push_back(fd);
      changed_.notify_all();
    };
  }
  void WaitFor(size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return fds_.size() >= count; });
  }
  void EndOne() {
    std::lock_guard lock(mutex_);
    shutdown(fds_.front(), SHUT_RDWR);
    close(fds_.front());
    fds_.pop_front();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<int> fds_;  // guarded by mutex_
};

class ConnectionListenerTest : public testing::Test {
 protected:
  void Start(ConnectionLimits limits) {
    listener_ = ConnectionListener::Open("127.0.0.1:0", limits).value();
    listener_->Start(owner_.hand_over(), [this](const std::string& what) {
      std::lock_guard lock(mutex_);
      reports_.push_back(what);
      reported_.notify_all();
    });
  }
  TcpClient Connect(const std::string& from = "127.0.0.1") {
    TcpClient client(listener_->port(), from);
    EXPECT_TRUE(client.ok());
    return client;
  }
  std::string FirstReport() {
    std::unique_lock lock(mutex_);
    reported_.wait(lock, [this] { return !reports_.empty(); });
    return reports_[0];
  }
  // Waits for the listener's own thread.
  void WaitForOpen(int count) {
    while (listener_->num_open() != count) std::this_thread::yield();
  }

  Owner owner_;
  std::mutex mutex_;
  std::condition_variable reported_;
  std::vector<std::string> reports_;  // guarded by mutex_
  std::unique_ptr<ConnectionListener> listener_;
};

TEST_F(ConnectionListenerTest, HandsOverAndNoticesBothKindsOfEnd) {
  Start({});
  TcpClient first = Connect(), second = Connect();
  owner_.WaitFor(2);
  WaitForOpen(2);
  first.Close();
  WaitForOpen(1);
  owner_.EndOne();
  owner_.EndOne();
  WaitForOpen(0);
  EXPECT_TRUE(second.WaitForEnd());
  EXPECT_EQ(listener_->num_refused(), 0u);
}

TEST_F(ConnectionListenerTest, WhatIsBeyondTheLimitIsClosedUntilThereIsRoom) {
  Start({.max_connections = 2});
  TcpClient first = Connect();
  const TcpClient second = Connect();
  owner_.WaitFor(2);
  EXPECT_TRUE(Connect().WaitForEnd());
  EXPECT_EQ(listener_->num_refused(), 1u);
  first.Close();
  WaitForOpen(1);
  const TcpClient third = Connect();
  owner_.WaitFor(3);
  EXPECT_THAT(FirstReport(), HasSubstr("127.0.0.1: the server has its most connections"));
}

TEST_F(ConnectionListenerTest, OnePeerLeavesRoomForOthers) {
  Start({.max_connections = 10, .max_connections_per_peer = 1});
  const TcpClient first = Connect();
  owner_.WaitFor(1);
  EXPECT_TRUE(Connect().WaitForEnd());
  const TcpClient other = Connect("127.0.0.2");
  owner_.WaitFor(2);
  EXPECT_EQ(listener_->num_open(), 2);
}

// The listener of gRPC 1.51 was deaf for ever after this.
TEST_F(ConnectionListenerTest, HearsAgainWhenDescriptorsAreBack) {
  Start({});
  std::vector<TcpClient> clients;
  for (int i = 0; i < 20; ++i) clients.push_back(Connect());
  owner_.WaitFor(20);
  WaitForOpen(20);
  // Clients that connect before the descriptors end: their sockets are made now.
  std::vector<int> sockets;
  for (int i = 0; i < 5; ++i) sockets.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 512;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<int> fillers;
  for (int fd = 0; (fd = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) fillers.push_back(fd);
  ASSERT_FALSE(fillers.empty());
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
  address.sin_port = htons(static_cast<uint16_t>(listener_->port()));
  for (const int fd : sockets) {
    EXPECT_EQ(connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    char byte = 0;
    EXPECT_LE(recv(fd, &byte, 1, 0), 0);  // closed, not left to wait
  }
  EXPECT_GE(listener_->num_refused(), sockets.size());
  for (const int fd : fillers) close(fd);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  for (const int fd : sockets) close(fd);
  const TcpClient later = Connect();
  owner_.WaitFor(21);
}

TEST_F(ConnectionListenerTest, EndsWhileConnectionsGoOn) {
  Start({});
  TcpClient client = Connect();
  owner_.WaitFor(1);
  const int port = listener_->port();
  listener_.reset();
  EXPECT_FALSE(TcpClient(port).ok());
  owner_.EndOne();
  EXPECT_TRUE(client.WaitForEnd());
}

TEST(ConnectionListenerOpenTest, NeedsAnAddress) {
  EXPECT_THAT(ConnectionListener::Open("nonsense", {}).status(),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("nonsense")));
}

}  // namespace
}  // namespace pleat
