#include "pleat/reactors/run_unary.h"

#include <gmock/gmock.h>
#include <grpcpp/server_context.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <new>
#include <optional>
#include <stdexcept>

#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class RunUnaryTest : public testing::Test {
 protected:
  RunUnaryTest() { spdlog::set_level(spdlog::level::off); }  // failures are what is tested
  void Start(std::function<absl::Status()> handler) {
    call_.emplace(RunUnary(&context_, &server_context_, executor_.get(), "Test", handler));
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
    context_.open_calls.WaitUntilNone();
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
  FakeUnaryCall waiting(RunUnary(&context_, &server_context_, executor_.get(), "Test", [this] {
    was_run_ = true;
    return absl::OkStatus();
  }));
  context_.draining = true;
  EXPECT_FALSE(context_.open_calls.WaitUntilNone({}));
  in_handler_.Release();
  EXPECT_EQ(waiting.WaitForEnd().error_code(), grpc::StatusCode::UNAVAILABLE);
  ExpectEnd(grpc::StatusCode::OK, "");
  EXPECT_FALSE(was_run_);
}

TEST_F(RunUnaryTest, TheEndMayComeBeforeGrpcHasTheReactor) {
  grpc::ServerUnaryReactor* const reactor = RunUnary(&context_, &server_context_, executor_.get(),
                                                     "Test", [] { return absl::OkStatus(); });
  executor_.RunAll();
  call_.emplace(reactor);
  ExpectEnd(grpc::StatusCode::OK, "");
}

}  // namespace
}  // namespace pleat
