#include "pleat/reactors/run_unary.h"

#include <gmock/gmock.h>
#include <grpcpp/server_context.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <new>
#include <optional>
#include <stdexcept>

#include "pleat/v1/model_service.pb.h"
#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class RunUnaryTest : public testing::Test {
 protected:
  RunUnaryTest() { spdlog::set_level(spdlog::level::off); }  // failures are what is tested
  UnaryCall Call() {
    return {
        .context = &context_, .call = &server_context_, .executor = executor_.get(), .rpc = "Test"};
  }
  void Start(std::function<absl::Status()> handler) {
    call_.emplace(RunUnary(Call(), [handler](HandlerContext&) { return handler(); }));
  }
  // A call that is in its handler until the test lets it go on.
  void StartHeld() {
    executor_.Release();
    Start([this] {
      in_handler_.Pass();
      return absl::OkStatus();
    });
    in_handler_.WaitUntilReached();
  }
  void ExpectEnd(grpc::StatusCode code, const std::string& word) {
    const grpc::Status status = call_->WaitForEnd();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(word));
    context_.calls->open_calls.WaitUntilNone();
  }

  Checkpoint in_handler_;
  HandlerContext context_;
  grpc::CallbackServerContext server_context_;
  HeldExecutor executor_;
  std::optional<FakeUnaryCall> call_;
  bool was_run_ = false;
};

TEST_F(RunUnaryTest, GivesTheStatusOfTheHandler) {
  executor_.Release();
  Start([] { return absl::OkStatus(); });
  ExpectEnd(grpc::StatusCode::OK, "");
  Start([] { return absl::NotFoundError("none"); });
  ExpectEnd(grpc::StatusCode::NOT_FOUND, "none");
}

TEST_F(RunUnaryTest, ExceptionsBecomeAStatus) {
  executor_.Release();
  Start([]() -> absl::Status { throw std::bad_alloc(); });
  ExpectEnd(grpc::StatusCode::RESOURCE_EXHAUSTED, "not enough memory");
  Start([]() -> absl::Status { throw std::runtime_error("odd"); });
  ExpectEnd(grpc::StatusCode::INTERNAL, "a fault of the server");
}

TEST_F(RunUnaryTest, ACallThatIsCancelledWhileItWaitsIsNotRun) {
  Start([this] {
    was_run_ = true;
    return absl::OkStatus();
  });
  call_->Cancel();
  executor_.Release();
  ExpectEnd(grpc::StatusCode::CANCELLED, "gave up");
  EXPECT_FALSE(was_run_);
}

TEST_F(RunUnaryTest, ACallThatIsCancelledWhileItRunsEndsByItself) {
  StartHeld();
  call_->Cancel();
  EXPECT_FALSE(call_->finished());
  in_handler_.Release();
  ExpectEnd(grpc::StatusCode::OK, "");
}

TEST_F(RunUnaryTest, AServerThatDrainsLetsTheRunningCallEndAndRefusesTheOneThatWaits) {
  StartHeld();
  FakeUnaryCall waiting(RunUnary(Call(), [this](HandlerContext&) {
    was_run_ = true;
    return absl::OkStatus();
  }));
  context_.calls->draining = true;
  EXPECT_FALSE(context_.calls->open_calls.WaitUntilNone({}));
  in_handler_.Release();
  EXPECT_EQ(waiting.WaitForEnd().error_code(), grpc::StatusCode::UNAVAILABLE);
  ExpectEnd(grpc::StatusCode::OK, "");
  EXPECT_FALSE(was_run_);
}

TEST_F(RunUnaryTest, TheEndMayComeBeforeGrpcHasTheReactor) {
  grpc::ServerUnaryReactor* const reactor =
      RunUnary(Call(), [](HandlerContext&) { return absl::OkStatus(); });
  executor_.RunAll();
  call_.emplace(reactor);
  ExpectEnd(grpc::StatusCode::OK, "");
}

TEST_F(RunUnaryTest, ACallWithoutMemoryIsRefusedBeforeItWaits) {
  MemoryBudget memory(kUnaryCallBytes + 4000, "--request-bytes");
  context_.calls->request_memory = &memory;
  v1::DeleteModelRequest small, large;
  large.set_id(std::string(4000, 'x'));
  UnaryCall call = Call();
  call.request = &large;
  call_.emplace(RunUnary(call, [this](HandlerContext&) {
    was_run_ = true;
    return absl::OkStatus();
  }));
  ExpectEnd(grpc::StatusCode::RESOURCE_EXHAUSTED, "--request-bytes");  // although nothing runs yet
  EXPECT_FALSE(was_run_);
  call.request = &small;
  FakeUnaryCall waiting(RunUnary(call, [](HandlerContext&) { return absl::OkStatus(); }));
  EXPECT_EQ(memory.used_bytes(), kUnaryCallBytes);
  executor_.Release();
  EXPECT_TRUE(waiting.WaitForEnd().ok());
  context_.calls->open_calls.WaitUntilNone();
  EXPECT_EQ(memory.used_bytes(), 0u);
}

TEST_F(RunUnaryTest, TheHandlerGetsTheContextOfItsProject) {
  executor_.Release();
  const HandlerContext* seen = nullptr;
  call_.emplace(RunUnary(Call(), [&](HandlerContext& context) {
    seen = &context;
    return absl::OkStatus();
  }));
  ExpectEnd(grpc::StatusCode::OK, "");
  EXPECT_EQ(seen, &context_);  // without tokens there is one project
}

}  // namespace
}  // namespace pleat
