#include "pleat/reactors/pull_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>

#include "pleat/v1/job_service.pb.h"
#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

using Message = v1::GetJobRequest;  // any message with a text

class PullStreamTest : public testing::Test {
 protected:
  PullStreamTest() {
    spdlog::set_level(spdlog::level::off);
    context_.calls->max_open_streams = 1;
  }
  // A stream of the numbers 1 to `last`.
  void Start(int last = 3) {
    StartWith([this, last](Message* message) -> absl::StatusOr<bool> {
      if (num_made_ == last) return false;
      message->set_id(std::to_string(++num_made_));
      return true;
    });
  }
  void StartWith(PullStream<Message>::Next next) {
    auto held = std::make_shared<int>();
    held_ = held;
    call_.emplace(StartReactor<PullStream<Message>>(
        &context_, executor_.get(), "Test",
        [held, next](Message* message) { return next(message); }));
  }
  void ExpectEnd(grpc::StatusCode code) {
    const grpc::Status status = call_->WaitForFinish();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_TRUE(held_.expired()) << "what the stream holds goes before its status";
    EXPECT_EQ(context_.calls->num_open_streams, 1);
    call_->WaitForEnd();
    context_.calls->open_calls.WaitUntilNone();
    EXPECT_EQ(context_.calls->num_open_streams, 0);
  }

  HandlerContext context_;
  HeldExecutor executor_;
  std::optional<FakeWriteCall<Message>> call_;
  std::weak_ptr<int> held_;
  int num_made_ = 0;
};

TEST_F(PullStreamTest, MakesAMessageWhenTheOneBeforeIsWritten) {
  executor_.Release();
  Start();
  for (const char* number : {"1", "2", "3"}) {
    EXPECT_EQ(call_->WaitForWrite().id(), number);
    executor_.RunAll();
    EXPECT_EQ(std::to_string(num_made_), number) << "made ahead of the client";
    call_->EndWrite();
  }
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(PullStreamTest, AClientThatIsGoneBeforeTheFirstMessageCostsNone) {
  Start();
  call_->Cancel();
  executor_.Release();
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_made_, 0);
}

TEST_F(PullStreamTest, CancelledWhileItWritesItMakesNoFurtherMessage) {
  executor_.Release();
  Start();
  call_->WaitForWrite();
  call_->Cancel();
  executor_.RunAll();
  EXPECT_FALSE(call_->finished()) << "the write is still under way";
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_made_, 1);
}

TEST_F(PullStreamTest, AWriteThatFailsIsTheEndEvenWithoutAWordOfCancellation) {
  executor_.Release();
  Start();
  call_->Receive();
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_made_, 2);
}

TEST_F(PullStreamTest, CancelledWhileItMakesAMessageItEndsAfterIt) {
  Checkpoint making;
  executor_.Release();
  StartWith([&](Message*) -> absl::StatusOr<bool> {
    ++num_made_;
    making.Pass();
    return true;
  });
  making.WaitUntilReached();
  call_->Cancel();
  making.Release();
  call_->EndWrite(false);  // the message was made, so it was handed over
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_made_, 1);
}

TEST_F(PullStreamTest, AServerThatDrainsLetsItGoOnToItsEnd) {
  executor_.Release();
  Start(2);
  call_->WaitForWrite();
  context_.calls->draining = true;
  call_->EndWrite();
  EXPECT_EQ(call_->Receive().id(), "2");
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(PullStreamTest, AServerThatDrainsRefusesTheOneThatWaits) {
  Start();
  context_.calls->draining = true;
  executor_.Release();
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(num_made_, 0);
}

TEST_F(PullStreamTest, MoreStreamsThanAllowedAreRefusedUntilOneHasEnded) {
  executor_.Release();
  const StreamSlot other(&context_);
  Start();
  EXPECT_EQ(call_->WaitForEnd().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(num_made_, 0);
}

TEST_F(PullStreamTest, AnErrorOrAnExceptionInTheMiddleIsItsStatus) {
  executor_.Release();
  StartWith([this](Message*) -> absl::StatusOr<bool> {
    if (++num_made_ < 2) return true;
    return absl::DataLossError("damaged");
  });
  call_->Receive();
  ExpectEnd(grpc::StatusCode::DATA_LOSS);
  StartWith([](Message*) -> absl::StatusOr<bool> { throw std::bad_alloc(); });
  ExpectEnd(grpc::StatusCode::RESOURCE_EXHAUSTED);
}

}  // namespace
}  // namespace pleat
