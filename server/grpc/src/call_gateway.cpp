#include "pleat/grpc/call_gateway.h"

#include <grpcpp/channel.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>
#include <vector>

#include "channel_gateway.h"

namespace pleat {
namespace {

grpc::ByteBuffer ToBuffer(std::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return grpc::ByteBuffer(&slice, 1);
}

std::string ToString(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  std::string bytes;
  if (!buffer.Dump(&slices).ok()) return bytes;
  bytes.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

// The codes are the same numbers.
absl::Status ToAbslStatus(const grpc::Status& status) {
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

// gRPC aborts the process when a value of metadata has other bytes.
bool IsPlain(std::string_view text) {
  return text.size() <= 1024 &&
         std::ranges::all_of(text, [](char c) { return c > ' ' && c < 0x7f; });
}

// A token that cannot be one is replaced by one that nobody has, so that it is refused and not
// taken for none.
void Introduce(const ForeignCaller& caller, grpc::ClientContext* context) {
  context->AddMetadata(kInsideKey, InsideSecret());
  if (!caller.token.empty()) {
    context->AddMetadata("authorization",
                         "Bearer " + (IsPlain(caller.token) ? caller.token : std::string("none")));
  }
  if (!caller.peer.empty() && IsPlain(caller.peer)) {
    context->AddMetadata(kForeignPeerKey, caller.peer);
  }
  if (!caller.shared.empty()) context->AddMetadata(kSharedContentKey, caller.shared);
  if (!caller.request_id.empty() && IsPlain(caller.request_id)) {
    context->AddMetadata("x-request-id", caller.request_id);
  }
}

// Each step has a tag of its own; a read may still be under way when others are waited for.
class QueueCall final : public GatewayCall {
 public:
  QueueCall(grpc::GenericStub* stub, const std::string& method, const ForeignCaller& caller) {
    Introduce(caller, &context_);
    stream_ = stub->PrepareCall(&context_, method, &queue_);
    stream_->StartCall(&start_);
    alive_ = Wait(&start_);
  }
  ~QueueCall() override {
    if (!finished_) {
      context_.TryCancel();
      End();
    }
    queue_.Shutdown();
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) {
    }
  }

  bool Send(std::string_view message) override {
    if (!alive_) return false;
    stream_->Write(ToBuffer(message), &write_);
    alive_ = Wait(&write_);
    return alive_;
  }
  void SendNoMore() override {
    if (!alive_) return;
    stream_->WritesDone(&write_);
    Wait(&write_);
  }
  Got Receive(std::string* message, double patience_seconds) override {
    if (!alive_) return Got::kEnd;
    if (!reading_) {
      reading_ = true;
      stream_->Read(&message_, &read_);
    }
    const auto deadline = std::chrono::system_clock::now() +
                          std::chrono::microseconds(static_cast<int64_t>(1e6 * patience_seconds));
    void* tag = nullptr;
    bool ok = false;
    if (queue_.AsyncNext(&tag, &ok, deadline) == grpc::CompletionQueue::TIMEOUT) {
      return Got::kNothingYet;
    }
    reading_ = false;
    alive_ = ok;
    if (!ok) return Got::kEnd;
    *message = ToString(message_);
    return Got::kMessage;
  }
  absl::Status Finish() override {
    if (!finished_) End();
    return ToAbslStatus(status_);
  }

 private:
  void End() {
    finished_ = true;
    alive_ = false;
    stream_->Finish(&status_, &finish_);
    Wait(&finish_);
  }

  // The steps of a call end in any order; a read that ends meanwhile is over with the call.
  bool Wait(void* expected) {
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) {
      if (tag == expected) return ok;
      if (tag == &read_) reading_ = false;
    }
    return false;
  }

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> stream_;
  grpc::ByteBuffer message_;
  grpc::Status status_;
  bool alive_ = false, reading_ = false, finished_ = false;
  char start_ = 0, write_ = 0, read_ = 0, finish_ = 0;  // tags
};

// Owns itself from Begin to OnDone. The hold keeps gRPC from ending it while others may still start
// a read or a write; it is given back by the end of the reads, after which nothing is started.
class ReactorCall final : public DuplexCall,
                          public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                          public std::enable_shared_from_this<ReactorCall> {
 public:
  explicit ReactorCall(DuplexListener listener) : listener_(std::move(listener)) {}

  void Begin(grpc::GenericStub* stub, const std::string& method, const ForeignCaller& caller) {
    self_ = shared_from_this();
    Introduce(caller, &context_);
    stub->PrepareBidiStreamingCall(&context_, method, {}, this);
    AddHold();
    std::lock_guard lock(mutex_);
    reading_ = true;
    StartRead(&received_);
    StartCall();
  }

  void Send(std::string_view message) override {
    std::lock_guard lock(mutex_);
    if (ended_ || writing_) return;
    writing_ = true;
    sent_ = ToBuffer(message);
    StartWrite(&sent_);
  }
  void ReceiveNext() override {
    std::lock_guard lock(mutex_);
    Read();
  }
  void Cancel() override {
    std::lock_guard lock(mutex_);
    if (ended_) return;
    context_.TryCancel();
    Read();  // which ends, and with it the call
  }

  void OnReadDone(bool ok) override {
    std::string message;
    {
      std::lock_guard lock(mutex_);
      reading_ = false;
      if (ok) {
        message = ToString(received_);
      } else {
        ended_ = true;
      }
    }
    if (ok) {
      listener_.on_message(std::move(message));
    } else {
      RemoveHold();
    }
  }
  void OnWriteDone(bool ok) override {
    {
      std::lock_guard lock(mutex_);
      writing_ = false;
      if (!ok) Read();  // finds the end
    }
    if (ok) listener_.on_sent();
  }
  void OnDone(const grpc::Status& status) override {
    const std::shared_ptr<ReactorCall> last = std::move(self_);
    listener_.on_end(ToAbslStatus(status));
    listener_ = {};
  }

 private:
  void Read() {  // with mutex_ held
    if (ended_ || reading_) return;
    reading_ = true;
    StartRead(&received_);
  }

  grpc::ClientContext context_;
  DuplexListener listener_;
  std::shared_ptr<ReactorCall> self_;
  std::mutex mutex_;  // guards all below
  grpc::ByteBuffer sent_, received_;
  bool reading_ = false, writing_ = false, ended_ = false;
};

class ChannelGateway final : public CallGateway {
 public:
  explicit ChannelGateway(std::shared_ptr<grpc::Channel> channel) : stub_(std::move(channel)) {}
  std::unique_ptr<GatewayCall> Start(const std::string& method,
                                     const ForeignCaller& caller) override {
    return std::make_unique<QueueCall>(&stub_, method, caller);
  }
  std::shared_ptr<DuplexCall> Open(const std::string& method, const ForeignCaller& caller,
                                   DuplexListener listener) override {
    auto call = std::make_shared<ReactorCall>(std::move(listener));
    call->Begin(&stub_, method, caller);
    return call;
  }

 private:
  grpc::GenericStub stub_;
};

}  // namespace

std::unique_ptr<CallGateway> MakeChannelGateway(std::shared_ptr<grpc::Channel> channel) {
  return std::make_unique<ChannelGateway>(std::move(channel));
}

}  // namespace pleat
