#include "call_listening.h"

#include <chrono>
#include <string>

namespace pleat {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerRpcInfo;

// Lives as long as its call. A call that ends without a status was cancelled.
class ListeningInterceptor final : public grpc::experimental::Interceptor {
 public:
  ListeningInterceptor(const CallListener* listener, const char* method)
      : listener_(listener), method_(method) {
    listener_->on_start(method_);
  }
  ~ListeningInterceptor() override {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    listener_->on_end(method_, status_, elapsed.count());
  }

  void Intercept(InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      status_ = methods->GetSendStatus().error_code();
    }
    methods->Proceed();
  }

 private:
  const CallListener* const listener_;
  const std::string method_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  int status_ = grpc::StatusCode::CANCELLED;
};

class ListeningFactory final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit ListeningFactory(const CallListener* listener) : listener_(listener) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(ServerRpcInfo* info) override {
    return new ListeningInterceptor(listener_, info->method());  // gRPC owns it
  }

 private:
  const CallListener* const listener_;
};

}  // namespace

std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>>
MakeCallListening(const CallListener* listener) {
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> factories;
  factories.push_back(std::make_unique<ListeningFactory>(listener));
  return factories;
}

}  // namespace pleat
