// Live sessions over a server that loses connections, answers nonsense and counts wrongly.
#include "remote_live_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "client/remote/scripted_server.h"
#include "client/remote/tetrahedron_stream.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/remote/live_session.h"
#include "pleat/service/limits.h"
#include "pleat/wire/limit_messages.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class LiveSessionScriptTest : public testing::Test {
 protected:
  using Script = std::function<grpc::Status(LiveStream*)>;

  // One connection: start and header, then `script`.
  auto Connection(Script script) {
    return [this, script](grpc::ServerContext*, LiveStream* stream) {
      start_ = Read(stream).start();
      WriteHeader(stream, frames_.header());
      return script(stream);
    };
  }
  static v1::LiveSessionRequest Read(LiveStream* stream) {
    v1::LiveSessionRequest request;
    EXPECT_TRUE(stream->Read(&request));
    return request;
  }
  static std::vector<v1::LiveSessionRequest::LivePose> ReadPoses(LiveStream* stream, int count) {
    std::vector<v1::LiveSessionRequest::LivePose> poses;
    while (count-- > 0) poses.push_back(Read(stream).pose());
    return poses;
  }
  static void WriteHeader(LiveStream* stream, const v1::StreamHeader& header) {
    v1::LiveSessionResponse response;
    *response.mutable_header() = header;
    stream->Write(response);
  }
  void Answer(LiveStream* stream, uint64_t number, uint32_t num_superseded = 0) {
    v1::LiveSessionResponse response;
    *response.mutable_frame() = frames_.Frame(number);
    response.mutable_report()->set_num_superseded(num_superseded);
    stream->Write(response);
  }
  static void Reject(LiveStream* stream, uint64_t number, int code) {
    v1::LiveSessionResponse response;
    response.mutable_rejection()->set_number(number);
    response.mutable_rejection()->set_code(code);
    response.mutable_rejection()->set_message("a joint is missing");
    AddLimitDetails(
        RefuseForLimit(
            {.limit = "--project-frames-per-second", .retry_after = absl::Milliseconds(40)}, ""),
        response.mutable_rejection()->mutable_details());
    stream->Write(response);
  }
  // To the client's last word.
  static grpc::Status End(LiveStream* stream) {
    v1::LiveSessionRequest request;
    EXPECT_FALSE(stream->Read(&request));
    return grpc::Status::OK;
  }

  absl::StatusOr<std::unique_ptr<LiveSession>> Open(LiveSessionOptions options = {}) {
    if (client_ == nullptr) client_ = server_.Connect();
    return client_->poses().OpenLiveSession({"m", {}, {2}, true}, options);
  }
  void Serve(std::vector<Script> connections) {
    auto& call = EXPECT_CALL(server_.poses, LiveSession);
    for (Script& script : connections) call.WillOnce(Connection(std::move(script)));
  }
  static void SendPoses(LiveSession& session, int count) {
    for (int k = 0; k < count; ++k) ASSERT_THAT(session.Send(k, PoseAt(k)), IsOk());
  }
  static void ExpectEnd(LiveSession& session, absl::StatusCode code) {
    LiveFrame frame;
    EXPECT_EQ(session.Receive(&frame).code(), code);
    EXPECT_TRUE(session.ended());
    EXPECT_EQ(session.Receive(&frame).code(), code);  // and so it stays
    EXPECT_THAT(session.Send(9, PoseAt(0)),
                HasStatus(absl::StatusCode::kUnavailable, HasSubstr("Receive says why")));
  }

  TetrahedronStream frames_;
  v1::LiveSessionRequest::Start start_;
  ScriptedServer server_;
  std::unique_ptr<RemoteCharacterService> client_;
};

TEST_F(LiveSessionScriptTest, StartsWithWhatWasAskedFor) {
  Serve({End});
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto session,
      Open({.stream = {.position_bits = 14}, .max_in_flight = 7, .latest_wins = true}));
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
  EXPECT_EQ(start_.character().model_id(), "m");
  EXPECT_THAT(start_.character().bone_scales(), testing::ElementsAre(2));
  EXPECT_TRUE(start_.character().skinned_only());
  EXPECT_EQ(start_.options().position_bits(), 14);
  EXPECT_EQ(start_.max_in_flight(), 7);
  EXPECT_TRUE(start_.latest_wins());
}

TEST_F(LiveSessionScriptTest, CreditsOutOfRangeReachNoServer) {
  for (const int max_in_flight : {-1, 0, static_cast<int>(kMaxPosesInFlight) + 1}) {
    EXPECT_THAT(Open({.max_in_flight = max_in_flight}),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("1 to")));
  }
}

TEST_F(LiveSessionScriptTest, AStreamThatDoesNotBeginWithItsHeaderIsNoSession) {
  auto& call = EXPECT_CALL(server_.poses, LiveSession);
  call.WillOnce([](auto*, LiveStream*) { return Refusal(); });
  call.WillOnce([this](auto*, LiveStream* stream) {
    Answer(stream, 0);
    return grpc::Status::OK;
  });
  // Parameters have no decoder, which a caller that asked for meshes takes for granted.
  call.WillOnce([this](auto*, LiveStream* stream) {
    v1::StreamHeader header = frames_.header();
    header.set_content(v1::STREAM_CONTENT_PARAMETERS);
    WriteHeader(stream, header);
    return grpc::Status::OK;
  });
  EXPECT_THAT(Open(), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
  EXPECT_THAT(Open(), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("no header")));
  EXPECT_THAT(Open(), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("another content")));
}

TEST_F(LiveSessionScriptTest, ErrorsOfOnePoseLeaveTheSessionAlive) {
  Serve({[this](LiveStream* stream) {
    ReadPoses(stream, 4);
    Reject(stream, 0, 3);
    Reject(stream, 1, 0);  // no error at all
    v1::LiveSessionResponse damaged;
    *damaged.mutable_frame() = frames_.Frame(2);
    damaged.mutable_frame()->mutable_draco()->resize(9);
    stream->Write(damaged);
    Answer(stream, 3);
    WriteHeader(stream, frames_.header());
    return End(stream);
  }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  SendPoses(*session, 4);
  LiveFrame frame;
  EXPECT_THAT(session->Receive(&frame),
              HasStatus(absl::StatusCode::kInvalidArgument, "a joint is missing"));
  EXPECT_EQ(frame.number, 0u);
  EXPECT_EQ(frame.positions.cols(), 0);
  EXPECT_EQ(session->Receive(&frame).code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(frame.number, 1u);
  EXPECT_EQ(session->Receive(&frame).code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(frame.number, 2u);
  ASSERT_THAT(session->Receive(&frame), IsOk());
  EXPECT_EQ(frame.number, 3u);
  EXPECT_LE((frame.positions - frames_.positions(0)).cwiseAbs().maxCoeff(), frames_.step_m());
  EXPECT_THAT(session->Receive(&frame),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("a second header")));
  EXPECT_FALSE(session->ended());
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, ARefusedPoseSaysWhenToComeAgain) {
  Serve({[](LiveStream* stream) {
    ReadPoses(stream, 1);
    Reject(stream, 0, 8);
    return End(stream);
  }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  SendPoses(*session, 1);
  session->SendDone();
  LiveFrame frame;
  const absl::Status status = session->Receive(&frame);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  ASSERT_TRUE(LimitRefusalOf(status));
  EXPECT_EQ(LimitRefusalOf(status)->retry_after, absl::Milliseconds(40));
}

TEST_F(LiveSessionScriptTest, NoMorePosesAreSupersededThanWereSent) {
  Serve({[this](LiveStream* stream) {
    ReadPoses(stream, 3);
    Answer(stream, 2, std::numeric_limits<uint32_t>::max());
    Answer(stream, 2, std::numeric_limits<int32_t>::max());  // of a pose that has its answer
    return End(stream);
  }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  SendPoses(*session, 3);
  LiveFrame frame;
  ASSERT_THAT(session->Receive(&frame), IsOk());
  EXPECT_EQ(frame.num_superseded, 2);
  ASSERT_THAT(session->Receive(&frame), IsOk());
  EXPECT_EQ(frame.num_superseded, 0);
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, ANewConnectionGetsThePosesWithoutAnAnswerAndTheirHistory) {
  Serve({[this](LiveStream* stream) {
           ReadPoses(stream, 4);
           Answer(stream, 0);
           Reject(stream, 1, 3);  // what the server did not take is no history
           return Unavailable();
         },
         [this](LiveStream* stream) {
           const auto poses = ReadPoses(stream, 2);
           EXPECT_EQ(poses[0].number(), 2u);
           EXPECT_EQ(poses[0].history_size(), 1);
           EXPECT_EQ(poses[0].history(0).root_position().x(), 0);
           EXPECT_EQ(poses[1].number(), 3u);
           EXPECT_EQ(poses[1].history_size(), 0);  // the pose before it is there
           for (const auto& pose : poses) EXPECT_EQ(pose.frames_received(), 0u);
           Answer(stream, 2);
           Answer(stream, 3);
           return End(stream);
         }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  SendPoses(*session, 4);
  LiveFrame frame;
  ASSERT_THAT(session->Receive(&frame), IsOk());
  EXPECT_FALSE(session->Receive(&frame).ok());
  for (const uint64_t number : {2u, 3u}) {
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.number, number);
    EXPECT_EQ(frame.resumed, number == 2);
  }
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, ACutIsNotGivenTheHistoryBeforeIt) {
  Serve({[this](LiveStream* stream) {
           ReadPoses(stream, 2);
           Answer(stream, 0);
           return grpc::Status(grpc::StatusCode::CANCELLED, "the server ends");
         },
         [this](LiveStream* stream) {
           const auto pose = ReadPoses(stream, 1)[0];
           EXPECT_TRUE(pose.restart());
           EXPECT_TRUE(pose.keyframe());
           EXPECT_EQ(pose.history_size(), 0);
           Answer(stream, 1);
           return End(stream);
         }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  SendPoses(*session, 1);
  ASSERT_THAT(session->Send(1, PoseAt(1), {}, true, true), IsOk());
  LiveFrame frame;
  for (const uint64_t number : {0u, 1u}) {
    ASSERT_THAT(session->Receive(&frame), IsOk());
    EXPECT_EQ(frame.number, number);
  }
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, WhereTheNewestWinsOnlyAsManyAreSentAgainAsMakeItsHistory) {
  constexpr int kNumPoses = 30, kKept = kMaxPosesPerQuery;
  Serve({[](LiveStream* stream) {
           ReadPoses(stream, kNumPoses);
           return Unavailable();
         },
         [this](LiveStream* stream) {
           const auto poses = ReadPoses(stream, kKept);
           EXPECT_EQ(poses.front().number(), uint64_t{kNumPoses - kKept});
           EXPECT_EQ(poses.back().number(), uint64_t{kNumPoses - 1});
           EXPECT_EQ(poses.front().history_size(), kMaxPosesPerQuery - 1);
           for (int k = 0; k < poses.front().history_size(); ++k) {  // the newest first
             EXPECT_EQ(poses.front().history(k).root_position().x(), kNumPoses - kKept - 1 - k);
           }
           Answer(stream, kNumPoses - 1, kKept - 1);
           return End(stream);
         }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.max_in_flight = 64, .latest_wins = true}));
  SendPoses(*session, kNumPoses);
  LiveFrame frame;
  ASSERT_THAT(session->Receive(&frame), IsOk());
  EXPECT_EQ(frame.number, kNumPoses - 1u);
  EXPECT_EQ(frame.num_superseded, kKept - 1);
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, AReaderWithoutNewPosesAcknowledgesAlone) {
  Serve({[this](LiveStream* stream) {
    ReadPoses(stream, 1);
    Answer(stream, 0);
    EXPECT_EQ(Read(stream).acknowledgement().frames_received(), 1u);
    return End(stream);
  }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.max_in_flight = 2, .latest_wins = true}));
  SendPoses(*session, 1);
  LiveFrame frame;
  ASSERT_THAT(session->Receive(&frame), IsOk());
  session->SendDone();
  ExpectEnd(*session, absl::StatusCode::kOutOfRange);
}

TEST_F(LiveSessionScriptTest, AnotherCharacterAfterReconnectingEndsTheSession) {
  EXPECT_CALL(server_.poses, LiveSession)
      .WillOnce(Connection([](LiveStream*) { return Unavailable(); }))
      .WillOnce([this](auto*, LiveStream* stream) {
        v1::StreamHeader header = frames_.header();
        header.mutable_box()->set_range(2 * header.box().range());
        WriteHeader(stream, header);
        return grpc::Status::OK;
      });
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  ExpectEnd(*session, absl::StatusCode::kDataLoss);
}

TEST_F(LiveSessionScriptTest, AttemptsInARowAreCountedAndARefusalIsNone) {
  for (const int max_reconnects : {0, 1}) {
    Serve(std::vector<Script>(max_reconnects + 1, [](LiveStream*) { return Unavailable(); }));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open({.max_reconnects = max_reconnects}));
    ExpectEnd(*session, absl::StatusCode::kUnavailable);
  }
  Serve({[](LiveStream*) { return Refusal(); }});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, Open());
  ExpectEnd(*session, absl::StatusCode::kPermissionDenied);
}

TEST_F(LiveSessionScriptTest, ASessionThatIsLeftWaitsForNothing) {
  Serve({End});
  PLEAT_ASSERT_OK_AND_ASSIGN(auto session, Open());
  SendPoses(*session, 0);
  session.reset();
}

}  // namespace
}  // namespace pleat
