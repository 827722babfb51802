#include "call_listening.h"

#include <chrono>
#include <optional>
#include <string>

#include "named_ids.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/observe/request_scope.h"
#include "pleat/reactors/admission.h"
#include "pleat/wire/limit_messages.h"
#include "trace_context.h"

namespace pleat {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerRpcInfo;

// Returns "DeleteModel" for "/pleat.v1.ModelService/DeleteModel", and nothing for foreign services.
std::string_view PleatRpc(std::string_view method) {
  constexpr std::string_view kPackage = "/pleat.v1.";
  if (method.substr(0, kPackage.size()) != kPackage) return {};
  return method.substr(method.rfind('/') + 1);
}

// Lives as long as its call. A call that ends without a status was cancelled.
class ListeningInterceptor final : public grpc::experimental::Interceptor {
 public:
  ListeningInterceptor(const CallListener* listener, RunningCalls* running, ServerRpcInfo* info)
      : listener_(listener), running_(running), call_(info->server_context()) {
    facts_.method = info->method();
    facts_.is_stream = info->type() != ServerRpcInfo::Type::UNARY;
    const RpcRule* rule = FindRpcRule(PleatRpc(facts_.method));
    facts_.audited = rule != nullptr && rule->audited;
    if (listener_ != nullptr) listener_->on_start(facts_.method);
  }
  ~ListeningInterceptor() override {
    facts_.project = running_->ProjectOf(*call_);
    entry_.reset();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    const RequestTag request{.id = facts_.request_id, .project = facts_.project};
    const RequestScope scope(request);
    if (listener_ != nullptr) listener_->on_end(facts_, status_, elapsed.count());
  }

  void Intercept(InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
      NoteCaller();
    }
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_MESSAGE)) {
      NoteRequest(methods->GetRecvMessage());
    }
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      NoteStatus(methods->GetSendStatus());
    }
    methods->Proceed();
  }

 private:
  void NoteCaller() {
    if (entry_) return;
    const CallOrigin origin = OriginOf(*call_);
    facts_.peer = PeerOf(*call_);
    facts_.token_id = origin.token_id;
    const auto chosen = call_->client_metadata().find("x-request-id");
    facts_.request_id =
        RequestIdOr(chosen == call_->client_metadata().end()
                        ? std::string()
                        : std::string(chosen->second.data(), chosen->second.size()));
    const auto trace = call_->client_metadata().find("traceparent");
    if (trace != call_->client_metadata().end()) {
      facts_.trace_id = TraceIdOf({trace->second.data(), trace->second.size()});
    }
    entry_.emplace(running_, origin, facts_.request_id, facts_.is_stream, call_);
  }

  void NoteStatus(const grpc::Status& status) {
    status_ = status.error_code();
    if (status_ != grpc::StatusCode::RESOURCE_EXHAUSTED) return;
    const auto refusal =
        LimitRefusalOf(WithLimitDetails(absl::ResourceExhaustedError(""), status.error_details()));
    if (refusal) facts_.limit = refusal->limit;
  }

  // The first message says what the call is about; later ones are data or poses.
  void NoteRequest(const void* message) {
    if (!facts_.audited || has_request_ || message == nullptr) return;
    has_request_ = true;
    // Every audited RPC is Pleat's, and every request of these is a generated class, whose first
    // and only base is Message.
    facts_.ids = NamedIds(*static_cast<const google::protobuf::Message*>(message));
  }

  const CallListener* const listener_;
  RunningCalls* const running_;
  const grpc::ServerContextBase* const call_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  CallFacts facts_;
  std::optional<RunningCalls::Entry> entry_;
  bool has_request_ = false;
  int status_ = grpc::StatusCode::CANCELLED;
};

class ListeningFactory final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  ListeningFactory(const CallListener* listener, RunningCalls* running)
      : listener_(listener), running_(running) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(ServerRpcInfo* info) override {
    return new ListeningInterceptor(listener_, running_, info);  // gRPC owns it
  }

 private:
  const CallListener* const listener_;
  RunningCalls* const running_;
};

}  // namespace

std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>>
MakeCallListening(const CallListener* listener, RunningCalls* running) {
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> factories;
  factories.push_back(std::make_unique<ListeningFactory>(listener, running));
  return factories;
}

}  // namespace pleat
