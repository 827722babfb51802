// One WebSocket of Beast. Included by http_server.cpp alone, so that Beast is compiled once.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "pleat/http/http_message.h"

namespace pleat {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Socket = websocket::stream<beast::tcp_stream>;

// One WebSocket on the thread of its connection. Others reach it through Gate, which knows whether
// it is still there.
class SocketRun {
 public:
  class Gate final : public WebSocketSink {
   public:
    explicit Gate(SocketRun* run) : run_(run) {}
    void Send(std::string bytes, bool is_text) override {
      Post([bytes = std::move(bytes), is_text](SocketRun* run) mutable {
        run->waiting_.push_back({std::move(bytes), is_text});
        run->Write();
      });
    }
    void ReadNext() override {
      Post([](SocketRun* run) { run->Read(); });
    }
    void Close(uint16_t code) override {
      Post([code](SocketRun* run) {
        run->close_code_ = code;
        run->Write();
      });
    }
    void Leave() {
      std::lock_guard lock(mutex_);
      run_ = nullptr;
    }

   private:
    template <typename Task>
    void Post(Task task) {
      std::lock_guard lock(mutex_);
      if (run_ == nullptr) return;
      asio::post(*run_->io_, [run = run_, task = std::move(task)]() mutable {
        if (!run->ended_) task(run);
      });
    }
    std::mutex mutex_;
    SocketRun* run_;  // guarded by mutex_
  };

  SocketRun(asio::io_context* io, Socket* socket, WebSocketSession* session)
      : io_(io), socket_(socket), session_(session), gate_(std::make_shared<Gate>(this)) {}

  // Returns when the WebSocket has ended.
  void Run() {
    auto work = asio::make_work_guard(*io_);
    session_->OnOpen(gate_);
    if (!ended_) io_->restart();
    while (!ended_ && io_->run_one() > 0) {
    }
    gate_->Leave();
    session_->OnEnd();
    work.reset();
    beast::get_lowest_layer(*socket_).close();
    io_->restart();
    io_->run();  // what was under way ends now, while its buffers are still there
  }
  void End() { ended_ = true; }

 private:
  struct Message {
    std::string bytes;
    bool is_text;
  };

  void Read() {
    if (reading_ || close_code_) return;
    reading_ = true;
    socket_->async_read(buffer_, [this](error_code error, size_t) {
      reading_ = false;
      if (error) return End();
      std::string bytes = beast::buffers_to_string(buffer_.data());
      buffer_.consume(buffer_.size());
      if (!ended_) session_->OnMessage(std::move(bytes), socket_->got_text());
    });
  }

  void Write() {
    if (writing_) return;
    if (waiting_.empty()) {
      if (!close_code_ || closing_) return;
      closing_ = true;
      socket_->async_close(static_cast<websocket::close_code>(*close_code_),
                           [this](error_code) { End(); });
      return;
    }
    writing_ = true;
    socket_->text(waiting_.front().is_text);
    socket_->async_write(asio::buffer(waiting_.front().bytes), [this](error_code error, size_t) {
      writing_ = false;
      if (error) return End();
      waiting_.pop_front();
      if (!ended_) session_->OnSent();
      Write();
    });
  }

  asio::io_context* const io_;
  Socket* const socket_;
  WebSocketSession* const session_;
  const std::shared_ptr<Gate> gate_;
  beast::flat_buffer buffer_;
  std::deque<Message> waiting_;
  std::optional<uint16_t> close_code_;
  bool reading_ = false, writing_ = false, closing_ = false, ended_ = false;
};

}  // namespace pleat
