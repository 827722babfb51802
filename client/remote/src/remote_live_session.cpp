// The client's half of a live session. Two threads of the caller meet here: one sends, one
// receives. There is no thread of our own. The receiving one therefore also notices the end of a
// connection, connects again, and acknowledges when half of the credits are used.
//
// gRPC allows one writer and one reader of a stream at a time. The reader is the receiving thread,
// which alone replaces the stream and therefore reads it without a lock. Writers take write_mutex_;
// Resume holds it from the end of the old stream until all poses have been sent on the new one. So
// a sender waits while the session reconnects and cannot come between the poses that are sent
// again. mutex_ guards the books: which poses have no answer, and how many replies came. Nobody
// writes to a stream or waits for one under mutex_, except Resume, whose new stream has no other
// writer.
//
// A pose enters Unanswered before it is written. When the write fails, nothing else has to be done:
// the same failure ends the read, and Resume sends the pose with all others. Poses are answered in
// order, so an answer takes the first one out of the list. It becomes history, as on the server,
// because a new session must be told the poses before its first one.
//
// A new stream counts its replies from 0, so acknowledgements begin again as well. Its header must
// agree with the old one, since the caller holds a decoder and buffers of this shape. The first
// frame of a difference stream is then a key frame by itself.
//
// A session ends once: by an error that does not pass, by too many failures in a row, or by the end
// of the stream after SendDone. end_ is written before ended_, which tells the sender.
#include "remote_live_session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "channel.h"
#include "pleat/base/status.h"
#include "pleat/service/limits.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/wire/limit_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"

namespace pleat {
namespace {

constexpr size_t kMaxEarlierPoses = kMaxPosesPerQuery - 1;  // the longest history of one pose
constexpr auto kConnectTime = std::chrono::seconds(2);

using Stream = grpc::ClientReaderWriter<v1::LiveSessionRequest, v1::LiveSessionResponse>;
using LivePoseMessage = v1::LiveSessionRequest::LivePose;

absl::Status BrokenSession(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("the server's live session is wrong: ", why));
}

// The poses that were sent and have no answer yet, and the poses before them, of which a new
// session must be told. Its size is bounded by max_in_flight, or with latest_wins by the longest
// history.
class Unanswered {
 public:
  explicit Unanswered(bool latest_wins) : latest_wins_(latest_wins) {}

  size_t size() const { return poses_.size(); }
  // With those that have been dropped: the server answers them too.
  size_t num_outstanding() const { return poses_.size() + static_cast<size_t>(num_dropped_); }

  void Add(LivePoseMessage pose) {
    poses_.push_back(std::move(pose));
    // With latest_wins, poses that are older than the history of the newest one are of no use to a
    // new session. They may still get an answer from this one.
    if (latest_wins_ && poses_.size() > kMaxEarlierPoses + 1) {
      Remember(PopFront());
      ++num_dropped_;
    }
  }

  // Notes that a reply has come, which also counts for the `num_superseded` poses before its own. A
  // pose that was rejected does not become history; those that it superseded do.
  void Answered(int num_superseded, bool rejected) {
    num_dropped_ -= num_superseded + 1;
    for (; num_dropped_ < 0 && !poses_.empty(); ++num_dropped_) {
      LivePoseMessage pose = PopFront();
      if (!rejected || num_dropped_ < -1) Remember(std::move(pose));
    }
    num_dropped_ = std::max(num_dropped_, 0);
  }

  // Returns everything that must be sent to a session that begins anew. The first pose brings its
  // history along.
  std::vector<LivePoseMessage> ForNewSession() {
    num_dropped_ = 0;
    std::vector<LivePoseMessage> messages(poses_.begin(), poses_.end());
    if (messages.empty()) return messages;
    LivePoseMessage& first = messages.front();
    if (first.history_size() == 0 && !first.restart()) {
      for (const v1::Pose& earlier : earlier_) *first.add_history() = earlier;
    }
    for (LivePoseMessage& message : messages) message.set_frames_received(0);
    return messages;
  }

 private:
  LivePoseMessage PopFront() {
    LivePoseMessage pose = std::move(poses_.front());
    poses_.pop_front();
    return pose;
  }
  void Remember(LivePoseMessage pose) {
    if (pose.restart() || pose.history_size() > 0) earlier_.clear();
    earlier_.push_front(std::move(*pose.mutable_pose()));
    for (v1::Pose& before : *pose.mutable_history()) earlier_.push_back(std::move(before));
    if (earlier_.size() > kMaxEarlierPoses) earlier_.resize(kMaxEarlierPoses);
  }

  const bool latest_wins_;
  std::deque<LivePoseMessage> poses_;  // oldest first
  std::deque<v1::Pose> earlier_;       // the poses before the first of poses_, newest first
  int num_dropped_ = 0;                // how many poses before poses_ have no answer yet
};

class RemoteLiveSession final : public LiveSession {
 public:
  RemoteLiveSession(std::shared_ptr<grpc::Channel> channel, v1::LiveSessionRequest start,
                    const LiveSessionOptions& options)
      : channel_(std::move(channel)),
        stub_(v1::PoseService::NewStub(channel_)),
        start_(std::move(start)),
        options_(options),
        unanswered_(options.latest_wins) {
    const auto& scales = start_.start().character().bone_scales();
    bone_scales_.assign(scales.begin(), scales.end());
  }
  ~RemoteLiveSession() override {
    if (context_ != nullptr) context_->TryCancel();
    if (stream_ != nullptr) FinishStream().IgnoreError();
  }

  // Starts a stream and reads its header. Call it with write_mutex_ held, or before there is a
  // second thread.
  absl::Status Connect() {
    stream_.reset();
    finished_ = false;
    context_ = std::make_unique<grpc::ClientContext>();
    stream_ = stub_->LiveSession(context_.get());
    stream_->Write(start_);  // when it fails, so does the read that follows
    v1::LiveSessionResponse response;
    if (!stream_->Read(&response)) return FinishStream();
    if (!response.has_header()) return BrokenSession("no header");
    PLEAT_ASSIGN_OR_RETURN(StreamHeader header, FromProto(response.header()));
    if (header.content != options_.stream.content) return BrokenSession("another content");
    num_received_ = num_acknowledged_ = 0;
    if (!header_.has_value()) {
      header_ = std::move(header);
      if (header_->content == StreamContent::kParameters) return absl::OkStatus();
      PLEAT_ASSIGN_OR_RETURN(FrameDecoder decoder, FrameDecoder::Create(*header_));
      decoder_.emplace(std::move(decoder));
      return absl::OkStatus();
    }
    if (header.topology != header_->topology || header.vertex_order != header_->vertex_order ||
        header.num_vertices != header_->num_vertices || !(header.box == header_->box)) {
      return BrokenSession("the header is another one after reconnecting");
    }
    return absl::OkStatus();
  }

  const StreamHeader& header() const override { return *header_; }
  const FrameDecoder& decoder() const override { return *decoder_; }
  bool ended() const override { return ended_; }

  absl::Status Send(uint64_t number, const Pose& pose, const std::vector<Pose>& history,
                    bool restart, bool keyframe) override {
    v1::LiveSessionRequest request;
    LivePoseMessage* message = request.mutable_pose();
    message->set_number(number);
    *message->mutable_pose() = ToProto(pose);
    for (const Pose& earlier : history) *message->add_history() = ToProto(earlier);
    message->set_restart(restart);
    message->set_keyframe(keyframe);
    std::unique_lock write_lock(write_mutex_, std::defer_lock);
    {
      std::unique_lock lock(mutex_);
      answered_.wait(lock, [this] {
        return ended_ || options_.latest_wins ||
               unanswered_.size() < static_cast<size_t>(options_.max_in_flight);
      });
    }
    write_lock.lock();
    {
      std::lock_guard lock(mutex_);
      if (ended_) return absl::UnavailableError("the live session has ended; Receive says why");
      message->set_frames_received(num_received_);
      num_acknowledged_ = num_received_;
      unanswered_.Add(*message);
    }
    stream_->Write(request);  // when it fails, Receive sees the end and sends the pose again
    return absl::OkStatus();
  }

  absl::Status Receive(LiveFrame* frame) override {
    frame->resumed = false;
    v1::LiveSessionResponse response;
    while (!ended_ && !stream_->Read(&response)) {
      PLEAT_RETURN_IF_ERROR(Resume());
      frame->resumed = true;
    }
    if (ended_) return end_;
    if (!response.has_frame() && !response.has_rejection()) return BrokenSession("a second header");
    TakeAnswer(response.report(), response.has_rejection(), frame);
    if (response.has_rejection()) {
      frame->number = response.rejection().number();
      frame->draco.clear();
      frame->positions.resize(3, 0);
      if (response.rejection().code() == 0) return BrokenSession("a rejection without an error");
      return WithLimitDetails(
          absl::Status(static_cast<absl::StatusCode>(response.rejection().code()),
                       response.rejection().message()),
          response.rejection().details());
    }
    frame->number = response.frame().number();
    frame->confidence = response.frame().confidence();
    frame->draco = std::move(*response.mutable_frame()->mutable_draco());
    frame->num_bytes = frame->draco.size();
    frame->mark = MarkOf(response.frame());
    if (header_->content == StreamContent::kParameters) {
      return TakeParameters(response.frame(), frame);
    }
    if (!options_.decode) return absl::OkStatus();
    return decoder_->Decode(frame->draco, frame->mark, &frame->positions);
  }

  void SendDone() override {
    std::lock_guard write_lock(write_mutex_);
    done_ = true;
    stream_->WritesDone();
  }

 private:
  // Returns how the stream ended. It may be called twice, which gRPC's own Finish does not allow.
  absl::Status FinishStream() {
    if (!finished_) finish_status_ = FromGrpcStatus(stream_->Finish());
    finished_ = true;
    return finish_status_;
  }

  absl::Status TakeParameters(const v1::Frame& message, LiveFrame* frame) {
    PLEAT_ASSIGN_OR_RETURN(frame->parameters, FromProto(message.parameters()));
    frame->parameters->confidence = frame->confidence;
    frame->num_bytes = message.parameters().ByteSizeLong();
    if (!options_.decode || options_.model == nullptr) return absl::OkStatus();
    if (!evaluator_.has_value()) evaluator_.emplace(options_.model);
    PLEAT_RETURN_IF_ERROR(evaluator_->Show(*frame->parameters, bone_scales_, &evaluated_));
    frame->positions = evaluated_.positions;
    return absl::OkStatus();
  }

  // Says whether a new attempt makes sense. A session that is cancelled while somebody still reads
  // it was cancelled by the server, which may be starting again.
  static bool MayPass(const absl::Status& status) {
    return IsTransient(status) || status.code() == absl::StatusCode::kCancelled;
  }

  void TakeAnswer(const v1::LiveReport& report, bool rejected, LiveFrame* frame) {
    frame->times = {report.queue_us(), report.evaluate_us(), report.encode_us(),
                    report.server_cpu_us(), report.evaluated_together()};
    num_failures_ = 0;
    bool acknowledge = false;
    {
      std::lock_guard lock(mutex_);
      // This reply answers one of them, whatever the server counts.
      const size_t most = std::max<size_t>(unanswered_.num_outstanding(), 1) - 1;
      frame->num_superseded = static_cast<int>(std::min<size_t>(report.num_superseded(), most));
      unanswered_.Answered(frame->num_superseded, rejected);
      ++num_received_;
      // Poses carry acknowledgements with them. One is sent alone only when half of the credits are
      // used and no pose has come by.
      acknowledge = options_.latest_wins && 2 * (num_received_ - num_acknowledged_) >=
                                                static_cast<uint64_t>(options_.max_in_flight);
    }
    answered_.notify_one();
    if (acknowledge) Acknowledge();
  }

  void Acknowledge() {
    std::lock_guard write_lock(write_mutex_);
    if (done_) return;
    v1::LiveSessionRequest request;
    {
      std::lock_guard lock(mutex_);
      num_acknowledged_ = num_received_;
      request.mutable_acknowledgement()->set_frames_received(num_received_);
    }
    stream_->Write(request);
  }

  // Call it when the stream has ended. Connects again and sends the poses without an answer, or
  // says why not.
  absl::Status Resume() {
    std::lock_guard write_lock(write_mutex_);
    absl::Status status = FinishStream();
    while (MayPass(status) && num_failures_ < options_.max_reconnects) {
      BackOff(num_failures_++, {});
      channel_->WaitForConnected(std::chrono::system_clock::now() + kConnectTime);
      status = Connect();
      if (!status.ok()) continue;
      std::lock_guard lock(mutex_);
      for (LivePoseMessage& pose : unanswered_.ForNewSession()) {
        v1::LiveSessionRequest request;
        *request.mutable_pose() = std::move(pose);
        stream_->Write(request);
      }
      if (done_) stream_->WritesDone();
      return absl::OkStatus();
    }
    {
      std::lock_guard lock(mutex_);
      end_ = status.ok() ? absl::OutOfRangeError("the live session has ended") : status;
      ended_ = true;
    }
    answered_.notify_all();
    return end_;
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::PoseService::Stub> stub_;
  const v1::LiveSessionRequest start_;
  const LiveSessionOptions options_;
  std::vector<double> bone_scales_;
  std::optional<StreamHeader> header_;   // set by the first Connect
  std::optional<FrameDecoder> decoder_;  // empty in streams of parameters
  std::optional<PoseEvaluator> evaluator_;
  EvaluatedFrame evaluated_;

  std::mutex write_mutex_;  // one writer at a time, and none while the stream is replaced
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<Stream> stream_;
  bool finished_ = false;  // Finish was called on stream_ and gave finish_status_
  absl::Status finish_status_;
  bool done_ = false;  // SendDone was called; guarded by write_mutex_

  std::mutex mutex_;  // taken after write_mutex_; guards the next four
  std::condition_variable answered_;
  Unanswered unanswered_;
  uint64_t num_received_ = 0, num_acknowledged_ = 0;  // replies of this stream

  std::atomic<bool> ended_ = false;
  absl::Status end_;      // why the session ended; used by the receiving thread alone
  int num_failures_ = 0;  // attempts in a row without an answer; used by the receiving thread alone
};

}  // namespace

absl::StatusOr<std::unique_ptr<LiveSession>> OpenRemoteLiveSession(
    std::shared_ptr<grpc::Channel> channel, v1::Character character,
    const LiveSessionOptions& options) {
  if (options.max_in_flight < 1 || options.max_in_flight > kMaxPosesInFlight) {
    return absl::InvalidArgumentError(absl::StrCat("max_in_flight is ", options.max_in_flight,
                                                   ", allowed are 1 to ", kMaxPosesInFlight));
  }
  v1::LiveSessionRequest request;
  v1::LiveSessionRequest::Start* start = request.mutable_start();
  *start->mutable_character() = std::move(character);
  *start->mutable_options() = ToProto(options.stream);
  start->set_max_in_flight(options.max_in_flight);
  start->set_latest_wins(options.latest_wins);
  auto session =
      std::make_unique<RemoteLiveSession>(std::move(channel), std::move(request), options);
  PLEAT_RETURN_IF_ERROR(session->Connect());
  return session;
}

}  // namespace pleat
