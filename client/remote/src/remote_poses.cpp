// Poses over the network: clips, single poses, live sessions.
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "remote_live_session.h"
#include "state.h"

namespace pleat {
namespace {

v1::Character CharacterOf(const ClipQuery& query) {
  return ToProto(CharacterQuery{query.model_id, query.bone_scales, query.skinned_only});
}

absl::Status BrokenStream(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("the server's stream of frames is wrong: ", why));
}

absl::StatusOr<FrameParameters> ParametersOf(const v1::Frame& frame) {
  PLEAT_ASSIGN_OR_RETURN(FrameParameters parameters, FromProto(frame.parameters()));
  parameters.confidence = frame.confidence();
  return parameters;
}

absl::Status TakeParameters(int number, const v1::Frame& frame, const ClipStreamSink& sink) {
  PLEAT_ASSIGN_OR_RETURN(const FrameParameters parameters, ParametersOf(frame));
  return sink.on_parameters(number, parameters);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> RemoteCharacterService::State::Model(
    RemoteCharacterService* service, const std::string& id) {
  std::lock_guard lock(model_mutex);
  if (model == nullptr || model_id != id) {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, service->DownloadModel(id, {}));
    PLEAT_ASSIGN_OR_RETURN(model, DecodeModel(bytes));
    model_id = id;
  }
  return model;
}

absl::Status RemoteCharacterService::StreamClip(const ClipQuery& query,
                                                const FrameEncoderOptions& encoding,
                                                const ClipStreamSink& sink) {
  const bool has_parameters = encoding.content == StreamContent::kParameters;
  if (has_parameters ? !sink.on_parameters : !sink.on_frame) {
    return absl::InvalidArgumentError(
        "the sink takes no frames: set on_parameters of streams of parameters, else on_frame");
  }
  v1::EvaluateClipRequest request;
  *request.mutable_character() = CharacterOf(query);
  *request.mutable_track() = ToProto(query.track);
  *request.mutable_options() = ToProto(encoding);
  grpc::ClientContext context;
  auto reader = state_->poses->EvaluateClip(&context, request);
  v1::EvaluateClipResponse response;
  absl::Status status;
  bool has_header = false;
  int next = 0;
  while (status.ok() && reader->Read(&response)) {
    if (response.has_header() != !has_header) {
      status = BrokenStream("the header is not first");
    } else if (!has_header) {
      has_header = true;
      const absl::StatusOr<StreamHeader> header = FromProto(response.header());
      status = header.status();
      if (status.ok() && sink.on_header) status = sink.on_header(*header);
    } else if (response.frame().number() != static_cast<uint64_t>(next)) {
      status = BrokenStream("a frame is missing");
    } else if (has_parameters) {
      status = TakeParameters(next++, response.frame(), sink);
    } else {
      status = sink.on_frame(next++, response.frame().draco(), MarkOf(response.frame()),
                             response.frame().confidence());
    }
  }
  if (!status.ok()) context.TryCancel();
  const absl::Status end = FromGrpcStatus(reader->Finish());
  PLEAT_RETURN_IF_ERROR(status);
  PLEAT_RETURN_IF_ERROR(end);
  return next == query.track.num_frames() ? absl::OkStatus() : BrokenStream("it ended too early");
}

absl::Status RemoteCharacterService::EvaluateClip(
    const ClipQuery& query,
    const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) {
  EvaluatedFrame frame;
  if (state_->options.stream.content == StreamContent::kParameters) {
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model,
                           state_->Model(this, query.model_id));
    PoseEvaluator evaluator(std::move(model));
    return StreamClip(
        query, state_->options.stream,
        {.on_parameters = [&](int t, const FrameParameters& parameters) -> absl::Status {
          PLEAT_RETURN_IF_ERROR(evaluator.Show(parameters, query.bone_scales, &frame));
          return consume(t, frame);
        }});
  }
  std::optional<FrameDecoder> decoder;
  return StreamClip(query, state_->options.stream,
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

absl::StatusOr<EvaluatedFrame> RemoteCharacterService::EvaluatePose(
    const ClipQuery& character, const std::vector<Pose>& poses) {
  v1::EvaluatePoseRequest request;
  v1::EvaluatePoseResponse response;
  *request.mutable_character() = CharacterOf(character);
  for (const Pose& pose : poses) *request.add_poses() = ToProto(pose);
  *request.mutable_options() = ToProto(state_->options.stream);
  EvaluatedFrame frame;
  if (state_->options.stream.content == StreamContent::kParameters) {
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model,
                           state_->Model(this, character.model_id));
    PLEAT_RETURN_IF_ERROR(state_->Call(state_->poses.get(), &v1::PoseService::Stub::EvaluatePose,
                                       request, &response));
    PLEAT_ASSIGN_OR_RETURN(const FrameParameters parameters, ParametersOf(response.frame()));
    PLEAT_RETURN_IF_ERROR(
        PoseEvaluator(std::move(model)).Show(parameters, character.bone_scales, &frame));
    return frame;
  }
  v1::GetStreamHeaderRequest header_request;
  v1::GetStreamHeaderResponse header_response;
  header_request.set_model_id(character.model_id);
  *header_request.mutable_options() = ToProto(state_->options.stream);
  PLEAT_RETURN_IF_ERROR(state_->Call(state_->poses.get(), &v1::PoseService::Stub::GetStreamHeader,
                                     header_request, &header_response));
  PLEAT_ASSIGN_OR_RETURN(StreamHeader header, FromProto(header_response.header()));
  PLEAT_ASSIGN_OR_RETURN(FrameDecoder decoder, FrameDecoder::Create(std::move(header)));
  PLEAT_RETURN_IF_ERROR(
      state_->Call(state_->poses.get(), &v1::PoseService::Stub::EvaluatePose, request, &response));
  frame.confidence = response.frame().confidence();
  PLEAT_RETURN_IF_ERROR(
      decoder.Decode(response.frame().draco(), MarkOf(response.frame()), &frame.positions));
  return frame;
}

absl::StatusOr<std::unique_ptr<LiveSession>> RemoteCharacterService::OpenLiveSession(
    const ClipQuery& character, const LiveSessionOptions& options) {
  std::shared_ptr<grpc::Channel> channel =
      state_->address.empty() ? state_->channel
                              : MakeChannel(state_->address, state_->options, ChannelUse::kLive);
  return OpenRemoteLiveSession(std::move(channel), CharacterOf(character), options);
}

}  // namespace pleat
