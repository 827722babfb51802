// gRPC's part of a call, played by a test: reads, writes and the end happen when the test says so,
// on the thread that says so. So every interleaving of a reactor's callbacks can be forced.
#pragma once

#include <grpcpp/support/server_callback.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

namespace pleat {

// Takes part in no network. It fails the test when the reactor breaks gRPC's rules: one read and
// one write at a time, one Finish, and nothing after it. GrpcCall is the interface of gRPC by which
// the reactor asks for what it needs.
template <typename GrpcCall, typename Reactor, typename Request, typename Response>
class FakeCall final : public GrpcCall {
 public:
  // What the reactor has asked for before is asked for now.
  explicit FakeCall(Reactor* reactor) : reactor_(reactor) { this->BindReactor(reactor); }

  // The test's side. What waits fails after a time that only a broken reactor takes.

  void WaitForRead() {
    std::unique_lock lock(mutex_);
    WaitFor(lock, [this] { return request_ != nullptr; });
  }
  // The client has sent `message`.
  void Send(const Request& message) {
    EXPECT_TRUE(SendUnlessFinished(message)) << "the call has ended";
  }
  // The same, or false when the call ends before it is read.
  bool SendUnlessFinished(const Request& message) {
    {
      std::unique_lock lock(mutex_);
      WaitFor(lock, [this] { return request_ != nullptr || status_.has_value(); });
      if (request_ == nullptr) return false;
      *request_ = message;
      request_ = nullptr;
    }
    reactor_->OnReadDone(true);
    return true;
  }
  // The client sends no more, or is gone.
  void EndReads() {
    {
      std::unique_lock lock(mutex_);
      if (!WaitFor(lock, [this] { return request_ != nullptr; })) return;
      request_ = nullptr;
    }
    reactor_->OnReadDone(false);
  }
  // The message that is being written, until EndWrite.
  Response WaitForWrite() {
    std::unique_lock lock(mutex_);
    if (!WaitFor(lock, [this] { return response_ != nullptr; })) return {};
    return *response_;
  }
  void EndWrite(bool ok = true) {
    WaitForWrite();
    {
      std::lock_guard lock(mutex_);
      response_ = nullptr;
    }
    reactor_->OnWriteDone(ok);
  }
  Response Receive() {
    const Response message = WaitForWrite();
    EndWrite();
    return message;
  }
  // The same, or false when the call ends without a further message.
  bool ReceiveUnlessFinished() {
    {
      std::unique_lock lock(mutex_);
      WaitFor(lock, [this] { return response_ != nullptr || status_.has_value(); });
      if (response_ == nullptr) return false;
      response_ = nullptr;
    }
    reactor_->OnWriteDone(true);
    return true;
  }
  void Cancel() { reactor_->OnCancel(); }
  bool reading() const {
    std::lock_guard lock(mutex_);
    return request_ != nullptr;
  }
  bool writing() const {
    std::lock_guard lock(mutex_);
    return response_ != nullptr;
  }
  bool finished() const {
    std::lock_guard lock(mutex_);
    return status_.has_value();
  }
  // The status of the call; the reactor is still gRPC's.
  grpc::Status WaitForFinish() {
    std::unique_lock lock(mutex_);
    if (!WaitFor(lock, [this] { return status_.has_value(); })) return {};
    EXPECT_EQ(response_, nullptr) << "a write is under way";
    return *status_;
  }
  // The same, and gRPC ends the read that is under way and lets go of the reactor.
  grpc::Status WaitForEnd() {
    grpc::Status status = WaitForFinish();
    if constexpr (requires { reactor_->OnReadDone(false); }) {
      if (reading()) EndReads();
    }
    reactor_->OnDone();
    return status;
  }

  // gRPC's side.

  void Finish(grpc::Status status) override {
    std::lock_guard lock(mutex_);
    EXPECT_FALSE(status_.has_value()) << "finished twice";
    status_ = std::move(status);
    changed_.notify_all();
  }
  void SendInitialMetadata() override {}
  // Overrides where GrpcCall has them.
  void Read(Request* request) {
    std::lock_guard lock(mutex_);
    EXPECT_EQ(request_, nullptr) << "two reads at a time";
    EXPECT_FALSE(status_.has_value()) << "read after the end";
    request_ = request;
    changed_.notify_all();
  }
  void Write(const Response* response, grpc::WriteOptions) {
    std::lock_guard lock(mutex_);
    EXPECT_EQ(response_, nullptr) << "two writes at a time";
    EXPECT_FALSE(status_.has_value()) << "written after the end";
    response_ = response;
    changed_.notify_all();
  }
  void WriteAndFinish(const Response* response, grpc::WriteOptions options, grpc::Status status) {
    Write(response, options);
    Finish(std::move(status));
  }

 private:
  grpc::internal::ServerReactor* reactor() override { return reactor_; }
  void CallOnDone() override { reactor_->OnDone(); }

  template <typename Condition>
  bool WaitFor(std::unique_lock<std::mutex>& lock, Condition condition) {
    const bool ok = changed_.wait_for(lock, std::chrono::seconds(20), condition);
    EXPECT_TRUE(ok) << "the reactor did not ask for what the test waits for";
    return ok;
  }

  Reactor* const reactor_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_. Null: nothing is asked for.
  Request* request_ = nullptr;
  const Response* response_ = nullptr;
  std::optional<grpc::Status> status_;
};

using FakeUnaryCall =
    FakeCall<grpc::ServerCallbackUnary, grpc::ServerUnaryReactor, int /*none*/, int /*none*/>;
template <typename Request>
using FakeReadCall = FakeCall<grpc::ServerCallbackReader<Request>, grpc::ServerReadReactor<Request>,
                              Request, int /*none*/>;
template <typename Response>
using FakeWriteCall = FakeCall<grpc::ServerCallbackWriter<Response>,
                               grpc::ServerWriteReactor<Response>, int /*none*/, Response>;
template <typename Request, typename Response>
using FakeBidiCall = FakeCall<grpc::ServerCallbackReaderWriter<Request, Response>,
                              grpc::ServerBidiReactor<Request, Response>, Request, Response>;

}  // namespace pleat
