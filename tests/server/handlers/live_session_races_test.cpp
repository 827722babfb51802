// A live session whose client, service and server act at the same time: the test plays gRPC and
// the service.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "pleat/handlers/stream_handlers.h"
#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"
#include "support/mock_services.h"

namespace pleat {
namespace {

// What the service knows of its one stream; replies are given when the test says so.
class ScriptedService {
 public:
  std::unique_ptr<PoseStream> Open(LiveListener* listener) {
    std::lock_guard lock(mutex_);
    listener_ = listener;
    return std::make_unique<Stream>(this);
  }
  bool is_open() const {
    std::lock_guard lock(mutex_);
    return listener_ != nullptr;
  }
  bool is_asked() const {
    std::lock_guard lock(mutex_);
    return is_asked_;
  }
  void set_ready(bool is_ready) {
    std::lock_guard lock(mutex_);
    is_ready_ = is_ready;
  }
  // From now on every answer is given at once, as a task.
  void AnswerOn(Executor* executor) {
    std::lock_guard lock(mutex_);
    executor_ = executor;
    poses_.clear();
  }
  // Waits until the session asks for an answer, and gives it.
  void Answer() {
    LiveListener* listener = nullptr;
    LiveReply reply;
    {
      std::unique_lock lock(mutex_);
      const bool asked =
          changed_.wait_for(lock, std::chrono::seconds(20), [this] { return is_asked_; });
      ASSERT_TRUE(asked) << "the session asked for no answer";
      is_asked_ = false;
      listener = listener_;
      reply.number = poses_.front();
      poses_.pop_front();
    }
    listener->OnReply(std::move(reply));
  }

 private:
  struct Stream final : PoseStream {
    explicit Stream(ScriptedService* owner) : service(owner) {}
    ~Stream() override {
      std::lock_guard lock(service->mutex_);
      EXPECT_FALSE(service->is_asked_) << "destroyed while a reply is under way";
      service->listener_ = nullptr;
    }
    const StreamHeader& header() const override { return stream_header; }
    bool HasRoom() const override { return true; }
    void Push(const LivePose& pose) override {
      std::lock_guard lock(service->mutex_);
      service->poses_.push_back(pose.number);
    }
    absl::Status Acknowledge(uint64_t) override { return absl::OkStatus(); }
    bool empty() const override {
      std::lock_guard lock(service->mutex_);
      return service->poses_.empty();
    }
    bool ready() const override {
      std::lock_guard lock(service->mutex_);
      return service->is_ready_ && !service->poses_.empty();
    }
    void Answer() override {
      std::lock_guard lock(service->mutex_);
      EXPECT_FALSE(service->is_asked_) << "two answers at a time";
      service->is_asked_ = true;
      service->changed_.notify_all();
      if (service->executor_ != nullptr) {
        service->executor_->Post([answering = service] { answering->Answer(); });
      }
    }
    ScriptedService* const service;
    const StreamHeader stream_header;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_.
  LiveListener* listener_ = nullptr;  // null: no stream is open
  std::deque<uint64_t> poses_;        // their numbers
  bool is_ready_ = true, is_asked_ = false;
  Executor* executor_ = nullptr;
};

class LiveSessionRaces : public testing::Test {
 protected:
  using Request = v1::LiveSessionRequest;

  LiveSessionRaces() {
    spdlog::set_level(spdlog::level::off);
    context_.poses = &poses_;
    context_.pose_executor = executor_.get();
    context_.calls->max_open_streams = 1;
    ON_CALL(poses_, OpenStream).WillByDefault([this](auto&&, auto&&, auto&&, LiveListener* to) {
      return service_.Open(to);
    });
    executor_.Release();
  }
  void Start() { call_.emplace(LiveSession(&context_, nullptr)); }
  // A session that has sent its header and reads.
  void StartOpen() {
    Start();
    call_->Send(StartMessage());
    EXPECT_TRUE(call_->Receive().has_header());
    call_->WaitForRead();
  }
  static Request StartMessage() {
    Request request;
    request.mutable_start()->mutable_character()->set_model_id(std::string(64, 'a'));
    return request;
  }
  static Request PoseMessage(uint64_t number) {
    Request request;
    request.mutable_pose()->set_number(number);
    request.mutable_pose()->mutable_pose()->add_rotations()->set_w(1);
    return request;
  }
  void Drain() {
    context_.calls->draining = true;
    context_.calls->live_sessions.DrainAll();
  }
  void ExpectEnd(grpc::StatusCode code) {
    const grpc::Status status = call_->WaitForFinish();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_FALSE(service_.is_open()) << "the model is let go before the status";
    context_.calls->live_sessions.DrainAll();  // what has ended may still be told to
    context_.calls->live_sessions.AbandonAll();
    call_->WaitForEnd();
    context_.calls->open_calls.WaitUntilNone();
    context_.calls->live_sessions.DrainAll();
  }

  ScriptedService service_;
  testing::NiceMock<MockPoseService> poses_;
  HandlerContext context_;
  HeldExecutor executor_;
  std::optional<FakeBidiCall<Request, v1::LiveSessionResponse>> call_;
};

TEST_F(LiveSessionRaces, AClientThatIsGoneBeforeTheFirstMessageOpensNothing) {
  EXPECT_CALL(poses_, OpenStream).Times(0);
  Start();
  call_->WaitForRead();
  call_->Cancel();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(LiveSessionRaces, AClientThatSendsNothingAtAllEndsItWell) {
  EXPECT_CALL(poses_, OpenStream).Times(0);
  Start();
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(LiveSessionRaces, AClientThatIsGoneWhileTheModelIsLoadedGetsNoHeader) {
  Checkpoint loading;
  EXPECT_CALL(poses_, OpenStream).WillOnce([&](auto&&, auto&&, auto&&, LiveListener* listener) {
    loading.Pass();
    return service_.Open(listener);
  });
  Start();
  call_->Send(StartMessage());
  loading.WaitUntilReached();
  call_->Cancel();
  EXPECT_FALSE(call_->finished() || call_->reading());
  loading.Release();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(LiveSessionRaces, CancelledWhileAFrameIsComputedItSendsNone) {
  StartOpen();
  call_->Send(PoseMessage(1));
  call_->Cancel();
  EXPECT_FALSE(call_->finished()) << "the service still computes";
  service_.Answer();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(LiveSessionRaces, CancelledWhileItWritesItEndsAfterTheWrite) {
  StartOpen();
  call_->Send(PoseMessage(1));
  service_.Answer();
  call_->Send(PoseMessage(2));
  call_->Cancel();
  EXPECT_FALSE(call_->finished()) << "the write is still under way";
  EXPECT_FALSE(service_.is_asked()) << "computed for nobody";
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(LiveSessionRaces, AWriteThatFailsIsTheEndEvenWithoutAWordOfCancellation) {
  StartOpen();
  call_->Send(PoseMessage(1));
  service_.Answer();
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(LiveSessionRaces, AServerThatDrainsEndsASessionThatReads) {
  StartOpen();
  Drain();
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AServerThatDrainsEndsASessionThatHasNotEvenStarted) {
  Start();
  Drain();
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AServerThatDrainsRefusesASessionThatComesLater) {
  Drain();
  Start();
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AServerThatDrainsWhileTheServiceComputesWaitsForIt) {
  StartOpen();
  call_->Send(PoseMessage(1));
  Drain();
  EXPECT_FALSE(call_->finished());
  service_.Answer();
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AServerThatDrainsWhileAFrameIsWrittenLetsItArrive) {
  StartOpen();
  call_->Send(PoseMessage(1));
  service_.Answer();
  call_->Send(PoseMessage(2));
  Drain();
  EXPECT_FALSE(call_->finished());
  EXPECT_EQ(call_->Receive().frame().number(), 1u);
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AMessageThatComesAfterTheEndIsIgnored) {
  StartOpen();
  Drain();
  call_->WaitForFinish();
  call_->Send(PoseMessage(1));
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(LiveSessionRaces, AFrameIsComputedWhenTheOneBeforeHasBeenWritten) {
  StartOpen();
  call_->Send(PoseMessage(1));
  service_.Answer();
  for (const int number : {2, 3, 4}) call_->Send(PoseMessage(number));
  EXPECT_FALSE(service_.is_asked()) << "a client that does not read costs one frame";
  for (const int number : {1, 2, 3}) {
    EXPECT_EQ(call_->Receive().frame().number(), static_cast<uint64_t>(number));
    service_.Answer();
  }
  EXPECT_EQ(call_->Receive().frame().number(), 4u);
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(LiveSessionRaces, PosesThatWaitForCreditsAreAnsweredWhenNoMessageCanFollow) {
  StartOpen();
  service_.set_ready(false);
  call_->Send(PoseMessage(1));
  EXPECT_FALSE(service_.is_asked());
  call_->EndReads();
  service_.Answer();
  EXPECT_EQ(call_->Receive().frame().number(), 1u);
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(LiveSessionRaces, AWrongMessageEndsItWhenTheServiceHasAnswered) {
  StartOpen();
  call_->Send(PoseMessage(1));
  call_->Send(StartMessage());
  EXPECT_FALSE(call_->finished());
  service_.Answer();
  ExpectEnd(grpc::StatusCode::INVALID_ARGUMENT);
}

// One thread sends, one reads, the service answers on its own, and at some moment the client is
// gone or the server drains. Sanitizers see what is not guarded; the reply that ends the call may
// be the last owner of the reactor.
TEST_F(LiveSessionRaces, EverythingAtTheSameTimeEndsOnce) {
  Executor several(2);
  for (int round = 0; round < 40; ++round) {
    context_.calls->draining = false;
    service_.AnswerOn(&several);
    Start();
    call_->Send(StartMessage());
    std::thread sending([this] {
      for (int i = 0; i < 200 && call_->SendUnlessFinished(PoseMessage(i)); ++i) {
      }
    });
    for (int i = 0; i < round % 10; ++i) call_->Receive();
    std::thread ending([this, round] { round % 2 == 0 ? call_->Cancel() : Drain(); });
    while (call_->ReceiveUnlessFinished()) {
    }
    ending.join();
    sending.join();
    ExpectEnd(round % 2 == 0 ? grpc::StatusCode::CANCELLED : grpc::StatusCode::UNAVAILABLE);
  }
}

}  // namespace
}  // namespace pleat
