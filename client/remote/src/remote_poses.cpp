#include "pleat/remote/remote_poses.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "remote_live_session.h"
#include "remote_state.h"

namespace pleat {
namespace {

v1::Character CharacterOf(const std::string& model_id, const PoseSessionOptions& options) {
  return ToProto(
      CharacterQuery{model_id, options.bone_scales, options.skinned_only, options.strengths});
}

absl::StatusOr<EncodedFrame> FrameOf(v1::Frame* message, StreamContent content) {
  EncodedFrame frame{.confidence = message->confidence(), .mark = MarkOf(*message)};
  if (content == StreamContent::kParameters) {
    PLEAT_ASSIGN_OR_RETURN(frame.parameters, FromProto(message->parameters()));
    frame.parameters->confidence = message->confidence();
  } else {
    frame.draco = std::move(*message->mutable_draco());
  }
  return frame;
}

class RemotePoseSession final : public PoseSession {
 public:
  RemotePoseSession(const RemoteState* state, v1::Character character,
                    const FrameEncoderOptions& encoder, StreamHeader header)
      : state_(state),
        character_(std::move(character)),
        encoder_(encoder),
        header_(std::move(header)) {}

  const StreamHeader& header() const override { return header_; }

  absl::StatusOr<EncodedFrame> Show(const std::vector<const Pose*>& poses) override {
    v1::EvaluatePoseRequest request;
    v1::EvaluatePoseResponse response;
    *request.mutable_character() = character_;
    for (const Pose* pose : poses) *request.add_poses() = ToProto(*pose);
    *request.mutable_options() = ToProto(encoder_);
    PLEAT_RETURN_IF_ERROR(state_->Call(state_->poses.get(), &v1::PoseService::Stub::EvaluatePose,
                                       request, &response));
    return FrameOf(response.mutable_frame(), encoder_.content);
  }

 private:
  const RemoteState* const state_;
  const v1::Character character_;
  const FrameEncoderOptions encoder_;
  const StreamHeader header_;
};

class RemoteClipSession final : public ClipSession {
 public:
  RemoteClipSession(v1::PoseService::Stub* stub, const v1::EvaluateClipRequest& request,
                    StreamContent content, int num_frames)
      : content_(content),
        num_frames_(num_frames),
        stream_(stub->EvaluateClip(&context_, request)) {}
  ~RemoteClipSession() override {
    if (ended_) return;
    context_.TryCancel();
    stream_->Finish();
  }

  absl::Status ReadHeader() {
    PLEAT_RETURN_IF_ERROR(Read());
    if (!response_.has_header()) return BrokenStream("the header is not first");
    PLEAT_ASSIGN_OR_RETURN(header_, FromProto(response_.header()));
    return done() ? ReadEnd() : absl::OkStatus();
  }

  const StreamHeader& header() const override { return header_; }
  bool done() const override { return next_ >= num_frames_; }
  int next_frame() const override { return next_; }
  absl::StatusOr<EncodedFrame> Next() override {
    PLEAT_RETURN_IF_ERROR(Read());
    if (response_.has_header()) return BrokenStream("a second header");
    if (response_.frame().number() != static_cast<uint64_t>(next_)) {
      return BrokenStream("a frame is missing");
    }
    ++next_;
    absl::StatusOr<EncodedFrame> frame = FrameOf(response_.mutable_frame(), content_);
    if (done()) PLEAT_RETURN_IF_ERROR(ReadEnd());
    return frame;
  }

 private:
  // Reads the next message into response_, or returns the reason why there is none.
  absl::Status Read() {
    if (ended_) return BrokenStream("it has ended");
    if (stream_->Read(&response_)) return absl::OkStatus();
    ended_ = true;
    PLEAT_RETURN_IF_ERROR(FromGrpcStatus(stream_->Finish()));
    return BrokenStream("it ended too early");
  }
  // Reads what follows the last frame, which must be the end, and returns the server's status.
  absl::Status ReadEnd() {
    v1::EvaluateClipResponse response;
    if (stream_->Read(&response)) return BrokenStream("it has more frames than the clip");
    ended_ = true;
    return FromGrpcStatus(stream_->Finish());
  }

  const StreamContent content_;
  const int num_frames_;
  grpc::ClientContext context_;
  const std::unique_ptr<grpc::ClientReader<v1::EvaluateClipResponse>> stream_;
  v1::EvaluateClipResponse response_;
  StreamHeader header_;
  int next_ = 0;
  bool ended_ = false;  // Finish was called on stream_
};

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> RemotePoses::Model(const std::string& id) {
  std::lock_guard lock(model_mutex_);
  if (model_ == nullptr || model_id_ != id) {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, models_->Download(id, {}));
    PLEAT_ASSIGN_OR_RETURN(model_, DecodeModel(bytes));
    model_id_ = id;
  }
  return model_;
}

absl::StatusOr<std::unique_ptr<PoseSession>> RemotePoses::OpenSession(const std::string& model_id,
                                                                      PoseSessionOptions options) {
  v1::GetStreamHeaderRequest request;
  v1::GetStreamHeaderResponse response;
  request.set_model_id(model_id);
  *request.mutable_options() = ToProto(options.encoder);
  PLEAT_RETURN_IF_ERROR(state_->Call(state_->poses.get(), &v1::PoseService::Stub::GetStreamHeader,
                                     request, &response));
  PLEAT_ASSIGN_OR_RETURN(StreamHeader header, FromProto(response.header()));
  return std::make_unique<RemotePoseSession>(state_, CharacterOf(model_id, options),
                                             options.encoder, std::move(header));
}

absl::StatusOr<std::unique_ptr<ClipSession>> RemotePoses::OpenClip(const std::string& model_id,
                                                                   PoseTrack track,
                                                                   PoseSessionOptions options) {
  v1::EvaluateClipRequest request;
  *request.mutable_character() = CharacterOf(model_id, options);
  *request.mutable_track() = ToProto(track);
  *request.mutable_options() = ToProto(options.encoder);
  return RetryRefused(state_->options, [&]() -> absl::StatusOr<std::unique_ptr<ClipSession>> {
    auto session = std::make_unique<RemoteClipSession>(state_->poses.get(), request,
                                                       options.encoder.content, track.num_frames());
    PLEAT_RETURN_IF_ERROR(session->ReadHeader());
    return session;
  });
}

absl::StatusOr<std::unique_ptr<PoseStream>> RemotePoses::OpenStream(const std::string&,
                                                                    PoseSessionOptions, LiveRules,
                                                                    LiveListener*) {
  return absl::UnimplementedError("poses go to a server through OpenLiveSession");
}

absl::Status RemotePoses::EvaluateClip(
    const ClipQuery& query,
    const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) {
  const FrameEncoderOptions& stream = state_->options.stream;
  EvaluatedFrame frame;
  if (stream.content == StreamContent::kParameters) {
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, Model(query.model_id));
    PoseEvaluator evaluator(std::move(model));
    return StreamClip(
        *this, query, stream,
        {.on_parameters = [&](int t, const FrameParameters& parameters) -> absl::Status {
          PLEAT_RETURN_IF_ERROR(evaluator.Show(parameters, query.bone_scales, &frame));
          return consume(t, frame);
        }});
  }
  std::optional<FrameDecoder> decoder;
  return StreamClip(*this, query, stream,
                    {.on_header = [&](const StreamHeader& header) -> absl::Status {
                       PLEAT_ASSIGN_OR_RETURN(FrameDecoder created, FrameDecoder::Create(header));
                       decoder.emplace(std::move(created));
                       return absl::OkStatus();
                     },
                     .on_frame = [&](int t, std::string_view draco, const FrameMark& mark,
                                     double confidence) -> absl::Status {
                       PLEAT_RETURN_IF_ERROR(decoder->Decode(draco, mark, &frame.positions));
                       frame.confidence = confidence;
                       return consume(t, frame);
                     }});
}

absl::StatusOr<EvaluatedFrame> RemotePoses::EvaluatePose(const ClipQuery& character,
                                                         const std::vector<Pose>& poses) {
  const FrameEncoderOptions& stream = state_->options.stream;
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<PoseSession> session,
                         OpenSession(character.model_id, {.bone_scales = character.bone_scales,
                                                          .skinned_only = character.skinned_only,
                                                          .encoder = stream}));
  std::vector<const Pose*> pointers;
  for (const Pose& pose : poses) pointers.push_back(&pose);
  PLEAT_ASSIGN_OR_RETURN(const EncodedFrame encoded, session->Show(pointers));
  EvaluatedFrame frame;
  if (encoded.parameters.has_value()) {
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, Model(character.model_id));
    PLEAT_RETURN_IF_ERROR(
        PoseEvaluator(std::move(model)).Show(*encoded.parameters, character.bone_scales, &frame));
    return frame;
  }
  PLEAT_ASSIGN_OR_RETURN(FrameDecoder decoder, FrameDecoder::Create(session->header()));
  frame.confidence = encoded.confidence;
  PLEAT_RETURN_IF_ERROR(decoder.Decode(encoded.draco, encoded.mark, &frame.positions));
  return frame;
}

absl::StatusOr<std::unique_ptr<LiveSession>> RemotePoses::OpenLiveSession(
    const ClipQuery& character, const LiveSessionOptions& options) {
  std::shared_ptr<grpc::Channel> channel =
      state_->address.empty() ? state_->channel
                              : MakeChannel(state_->address, state_->options, ChannelUse::kLive);
  const v1::Character message =
      CharacterOf(character.model_id,
                  {.bone_scales = character.bone_scales, .skinned_only = character.skinned_only});
  return RetryRefused(state_->options,
                      [&] { return OpenRemoteLiveSession(channel, message, options); });
}

}  // namespace pleat
