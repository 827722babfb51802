#include "pleat/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <thread>

#include "pleat/base/limit_refusal.h"
#include "server/http/http_client.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::_;
using testing::HasSubstr;

// Answers with what it was asked.
class EchoHandler final : public HttpHandler {
 public:
  absl::StatusOr<BodyPlan> PlanBody(const HttpRequest& head) override {
    if (head.target == "/refuse") return absl::PermissionDeniedError("not you");
    return BodyPlan{.max_bytes = 1000};
  }
  HttpResponse Handle(const HttpRequest& request) override {
    ++num_requests;
    if (request.target == "/pieces") {
      auto left = std::make_shared<int>(3);
      return {.next = [left](std::string* piece) -> absl::StatusOr<bool> {
        *piece = *left == 2 ? "" : absl::StrCat("piece ", *left, "\n");
        return --*left > 0;
      }};
    }
    if (request.target == "/broken") {
      auto first = std::make_shared<bool>(true);
      return {.next = [first](std::string* piece) -> absl::StatusOr<bool> {
        if (!*first) return absl::DataLossError("gone");
        *first = false;
        *piece = "half";
        return true;
      }};
    }
    return {.body = absl::StrCat(request.method, " ", request.target, " ", request.body)};
  }
  // Sends each message back; "end" ends it.
  class Echo final : public WebSocketSession {
   public:
    explicit Echo(std::atomic<int>* num_open) : num_open_(num_open) { ++*num_open_; }
    ~Echo() override { --*num_open_; }
    void OnOpen(std::shared_ptr<WebSocketSink> sink) override {
      sink_ = std::move(sink);
      sink_->ReadNext();
    }
    void OnMessage(std::string bytes, bool is_text) override {
      if (bytes == "end") return sink_->Close(1000);
      sink_->Send(std::move(bytes), is_text);
    }
    void OnSent() override { sink_->ReadNext(); }
    void OnEnd() override {}

   private:
    std::atomic<int>* num_open_;
    std::shared_ptr<WebSocketSink> sink_;
  };
  absl::StatusOr<std::unique_ptr<WebSocketSession>> OpenWebSocket(
      const HttpRequest& head) override {
    if (head.target != "/live") return absl::NotFoundError("no such socket");
    return std::make_unique<Echo>(&num_open);
  }
  std::atomic<int> num_requests = 0, num_open = 0;
};

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() { spdlog::set_level(spdlog::level::err); }
  std::string Ask(const std::string& method, const std::string& target,
                  const std::string& body = "") {
    return HttpClient::Ask(server_->address(), method, target, {}, body);
  }
  std::string Upgrade(const std::string& target) {
    return absl::StrCat(
        "GET ", target, " HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
  }
  // A masked frame of a client, with the mask 0.
  static std::string Frame(int opcode, const std::string& bytes) {
    std::string frame{static_cast<char>(0x80 | opcode), static_cast<char>(0x80 | bytes.size())};
    return frame + std::string(4, '\0') + bytes;
  }

  EchoHandler handler_;
  std::unique_ptr<HttpServer> server_ =
      HttpServer::Start(
          {.step_seconds = 5, .max_header_bytes = 4096, .max_socket_message_bytes = 100}, &handler_)
          .value();
};

TEST_F(HttpServerTest, AnswersAndKeepsTheConnection) {
  EXPECT_EQ(HttpClient::BodyOf(Ask("POST", "/a?b", "body")), "POST /a?b body");
  HttpClient client(server_->address());
  client.Send(
      "GET /1 HTTP/1.1\r\nHost: x\r\n\r\nGET /2 HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  const std::string both = client.ReadAll();
  EXPECT_THAT(both, HasSubstr("GET /1"));
  EXPECT_THAT(both, HasSubstr("GET /2"));
}

TEST_F(HttpServerTest, HeadHasNoBody) { EXPECT_EQ(HttpClient::BodyOf(Ask("HEAD", "/a")), ""); }

TEST_F(HttpServerTest, PiecesAreChunksAndAStreamThatBreaksIsNotWhole) {
  const std::string whole = Ask("GET", "/pieces");
  EXPECT_THAT(whole, HasSubstr("piece 3\n"));
  EXPECT_THAT(whole, HasSubstr("piece 1\n"));
  EXPECT_THAT(whole, testing::EndsWith("0\r\n\r\n"));
  const std::string broken = Ask("GET", "/broken");
  EXPECT_THAT(broken, HasSubstr("half"));
  EXPECT_THAT(broken, testing::Not(testing::EndsWith("0\r\n\r\n")));
}

TEST_F(HttpServerTest, BodiesAreBoundedBeforeTheyAreRead) {
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/a", std::string(1001, 'x'))), 413);
  HttpClient chunked(server_->address());
  chunked.Send("POST /a HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n800\r\n" +
               std::string(0x800, 'x') + "\r\n");
  EXPECT_EQ(HttpClient::StatusOf(chunked.ReadAll()), 413);
  HttpClient huge(server_->address());
  huge.Send("POST /a HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999\r\n\r\n");
  EXPECT_EQ(HttpClient::StatusOf(huge.ReadAll()), 413);
  EXPECT_EQ(handler_.num_requests, 0);
}

TEST_F(HttpServerTest, ARefusalComesBeforeTheBody) {
  HttpClient client(server_->address());
  client.Send("POST /refuse HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n");
  const std::string response = client.ReadAll();
  EXPECT_EQ(HttpClient::StatusOf(response), 403);
  EXPECT_THAT(response, HasSubstr("not you"));
}

TEST_F(HttpServerTest, WhatIsNoHttpIsRefusedAndTheServerGoesOn) {
  for (const std::string& bad :
       {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11), std::string("GET\r\n\r\n"),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nA B: c\r\n\r\n"),
        "GET / HTTP/1.1\r\nLong: " + std::string(8000, 'x') + "\r\n\r\n",
        std::string("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n"),
        std::string(
            "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nab"),
        std::string("POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n")}) {
    HttpClient client(server_->address());
    client.Send(bad);
    const int status = HttpClient::StatusOf(client.ReadAll());
    EXPECT_TRUE(status == 0 || status == 400) << bad << status;
  }
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/still")), 200);
}

TEST_F(HttpServerTest, EveryTruncationOfARequestIsHarmless) {
  ForEachTruncation("POST /a HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\n\r\nbody",
                    [&](const auto& part) {
                      HttpClient client(server_->address());
                      client.Send(std::string(part));
                    });
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/still")), 200);
}

TEST_F(HttpServerTest, WebSocketsCarryMessages) {
  HttpClient client(server_->address());
  client.Send(Upgrade("/live"));
  EXPECT_THAT(client.ReadUntil("\r\n\r\n"), HasSubstr("101 Switching"));
  client.Send(Frame(1, "hello"));
  EXPECT_THAT(client.ReadUntil("hello"), HasSubstr(std::string("\x81\x05", 2) + "hello"));
  client.Send(Frame(2, "bytes"));
  EXPECT_THAT(client.ReadUntil("bytes"), HasSubstr(std::string("\x82\x05", 2) + "bytes"));
  client.Send(Frame(1, "end"));
  EXPECT_THAT(client.ReadUntil(std::string("\x88\x02", 2)), HasSubstr(std::string("\x88\x02", 2)));
}

TEST_F(HttpServerTest, AMessageThatIsTooLargeEndsItsSocket) {
  HttpClient client(server_->address());
  client.Send(Upgrade("/live"));
  client.ReadUntil("\r\n\r\n");
  // 2^62 bytes are declared: nothing of that is allocated.
  client.Send(std::string("\x82\xff\x40\0\0\0\0\0\0\0", 10) + std::string(4, '\0'));
  client.ReadAll();
  HttpClient other(server_->address());
  other.Send(Upgrade("/nothing"));
  EXPECT_EQ(HttpClient::StatusOf(other.ReadAll()), 404);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/still")), 200);
}

TEST_F(HttpServerTest, ShutdownEndsWhatIsOpen) {
  HttpClient idle(server_->address()), socket(server_->address());
  socket.Send(Upgrade("/live"));
  socket.ReadUntil("\r\n\r\n");
  server_->Shutdown();
  EXPECT_EQ(idle.ReadAll(), "");
  socket.ReadAll();
  EXPECT_EQ(handler_.num_open, 0);
}

TEST_F(HttpServerTest, ConnectionsAreBounded) {
  EchoHandler handler;
  const auto small = HttpServer::Start({.max_connections = 1}, &handler).value();
  HttpClient first(small->address());
  first.Send("GET /a HTTP/1.1\r\nHost: x\r\n\r\n");
  first.ReadUntil("GET /a");
  HttpClient second(small->address());
  second.Send("GET /b HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_EQ(second.ReadAll(), "");
}

TEST_F(HttpServerTest, AnAddressThatIsTakenIsNamed) {
  EXPECT_THAT(HttpServer::Start({.listen = server_->address()}, &handler_),
              HasStatus(absl::StatusCode::kUnavailable, HasSubstr(server_->address())));
  EXPECT_THAT(HttpServer::Start({.listen = "nowhere"}, &handler_),
              HasStatus(absl::StatusCode::kInvalidArgument, _));
}

}  // namespace
}  // namespace pleat
