#include "listening_socket.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "absl/strings/str_cat.h"
#include "server/grpc/sockets.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ListeningSocketTest, TakesAFreePortAndSaysWhich) {
  for (const char* address : {"127.0.0.1:0", "localhost:0", "0.0.0.0:0"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const ListeningSocket socket, ListeningSocket::Open(address));
    EXPECT_GT(socket.port(), 0);
    EXPECT_TRUE(TcpClient(socket.port()).ok()) << address;
  }
}

TEST(ListeningSocketTest, NobodyElseListensThere) {
  std::optional<ListeningSocket> socket(ListeningSocket::Open("127.0.0.1:0").value());
  const std::string address = absl::StrCat("127.0.0.1:", socket->port());
  EXPECT_THAT(ListeningSocket::Open(address).status(),
              HasStatus(absl::StatusCode::kUnavailable, HasSubstr(address)));
  socket.reset();
  EXPECT_TRUE(ListeningSocket::Open(address).ok());
}

TEST(ListeningSocketTest, AUnixSocketGoesWithItsOwner) {
  TemporaryFolder folder;
  const std::string path = folder.File("socket");
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const ListeningSocket socket, ListeningSocket::Open("unix:" + path));
    EXPECT_EQ(socket.port(), 0);
    EXPECT_TRUE(std::filesystem::is_socket(path));
    EXPECT_FALSE(ListeningSocket::Open("unix:" + path).ok());
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ListeningSocketTest, WhatIsNoAddressIsSaid) {
  for (const std::string& wrong :
       {std::string(), std::string("localhost"), std::string("1.2.3.4:"), std::string("unix:"),
        std::string("127.0.0.1:http!"), std::string("127.0.0.1:99999"),
        "unix:" + std::string(200, 'x')}) {
    EXPECT_THAT(ListeningSocket::Open(wrong).status(),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(wrong)));
  }
  EXPECT_THAT(ListeningSocket::Open("no such host:1").status(),
              HasStatus(absl::StatusCode::kUnavailable, HasSubstr("no such host:1")));
}

}  // namespace
}  // namespace pleat
