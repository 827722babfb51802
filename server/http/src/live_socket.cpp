#include <nlohmann/json.hpp>
#include <utility>

#include "pleat/base/utf8.h"
#include "rpc_routes.h"

namespace pleat {
namespace {

constexpr uint16_t kNormalClosure = 1000, kPolicyViolation = 1008;

// A pump between a WebSocket and a call: one message is under way in each direction, and the next
// one is read when the other side has taken it. So a client that does not read holds up its own
// session, and nothing is queued here.
class LiveSocket final : public WebSocketSession {
 public:
  LiveSocket(CallGateway* gateway, ForeignCaller caller)
      : gateway_(gateway), caller_(std::move(caller)) {}

  void OnOpen(std::shared_ptr<WebSocketSink> sink) override {
    sink_ = std::move(sink);
    sink_->ReadNext();
  }

  void OnMessage(std::string bytes, bool is_text) override {
    if (call_ == nullptr && is_text && TakeHello(bytes)) {
      Begin();
      sink_->ReadNext();
    } else if (call_ != nullptr && !is_text) {
      call_->Send(bytes);  // on_sent asks for the next one
    } else {
      sink_->Close(kPolicyViolation);
    }
  }
  // The call is read one message at a time; after its end this has no effect.
  void OnSent() override {
    if (call_ != nullptr) call_->ReceiveNext();
  }
  void OnEnd() override {
    if (call_ != nullptr) call_->Cancel();
  }

 private:
  bool TakeHello(const std::string& text) {
    const nlohmann::json hello = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!hello.is_object()) return false;
    const auto token = hello.find("token");
    if (token == hello.end() || !token->is_string()) return false;
    caller_.token = token->get<std::string>();
    return true;
  }

  // The listener outlives the session, so it holds the sink alone.
  void Begin() {
    const std::shared_ptr<WebSocketSink> sink = sink_;
    call_ = gateway_->Open(
        "/pleat.v1.PoseService/LiveSession", caller_,
        {.on_message = [sink](std::string message) { sink->Send(std::move(message), false); },
         .on_sent = [sink] { sink->ReadNext(); },
         .on_end =
             [sink](const absl::Status& status) {
               sink->Send(nlohmann::json{{"code", absl::StatusCodeToString(status.code())},
                                         {"message", ToValidUtf8(std::string(status.message()))}}
                              .dump(),
                          true);
               sink->Close(kNormalClosure);
             }});
  }

  CallGateway* const gateway_;
  ForeignCaller caller_;
  std::shared_ptr<WebSocketSink> sink_;
  std::shared_ptr<DuplexCall> call_;
};

}  // namespace

std::unique_ptr<WebSocketSession> MakeLiveSocket(CallGateway* gateway, ForeignCaller caller) {
  return std::make_unique<LiveSocket>(gateway, std::move(caller));
}

}  // namespace pleat
