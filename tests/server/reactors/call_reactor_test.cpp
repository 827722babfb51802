#include "pleat/reactors/call_reactor.h"

#include <gtest/gtest.h>

#include <memory>

#include "server/reactors/fake_call.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

class TestReactor final : public CallReactor<grpc::ServerUnaryReactor> {
 public:
  TestReactor(HandlerContext* context, Executor* executor, int* num_runs)
      : CallReactor(context), executor_(executor), num_runs_(num_runs) {}
  void Start() {}
  void Wake() {
    Post(executor_, [this] { ++*num_runs_; });
  }
  using CallReactor::Hold;

 private:
  Executor* const executor_;
  int* const num_runs_;
};

class CallReactorTest : public testing::Test {
 protected:
  bool exists() { return !context_.calls->open_calls.WaitUntilNone({}); }

  HandlerContext context_;
  int num_runs_ = 0;
  HeldExecutor executor_;
  TestReactor* const reactor_ = StartReactor<TestReactor>(&context_, executor_.get(), &num_runs_);
};

TEST_F(CallReactorTest, LivesUntilGrpcLetsGo) {
  EXPECT_TRUE(exists());
  reactor_->OnDone();
  EXPECT_FALSE(exists());
}

TEST_F(CallReactorTest, ATaskThatIsStillQueuedKeepsItAlive) {
  reactor_->Wake();
  reactor_->Wake();
  reactor_->OnDone();
  EXPECT_TRUE(exists());
  executor_.RunAll();
  EXPECT_EQ(num_runs_, 2);
  EXPECT_FALSE(exists());
}

TEST_F(CallReactorTest, ATaskThatHasRunKeepsNothing) {
  reactor_->Wake();
  executor_.RunAll();
  EXPECT_TRUE(exists());
  reactor_->OnDone();
  EXPECT_FALSE(exists());
}

TEST_F(CallReactorTest, AForeignCallbackMayHoldIt) {
  std::shared_ptr<const void> hold = reactor_->Hold();
  reactor_->OnDone();
  EXPECT_TRUE(exists());
  hold.reset();
  EXPECT_FALSE(exists());
}

}  // namespace
}  // namespace pleat
