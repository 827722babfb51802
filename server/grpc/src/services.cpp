#include "services.h"

#include "pleat/handlers/stream_handlers.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/reactors/admission.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"

// A unary method `rpc` that runs pleat::rpc on the context's `executor`.
#define PLEAT_UNARY(rpc, executor)                                                         \
  grpc::ServerUnaryReactor* rpc(grpc::CallbackServerContext* call,                         \
                                const v1::rpc##Request* request, v1::rpc##Response* reply) \
      override {                                                                           \
    return RunUnary({context_, call, context_->executor, #rpc, request, reply},            \
                    [=](HandlerContext& of) { return pleat::rpc(of, *request, reply); });  \
  }

// The same for a handler that is told who asks.
#define PLEAT_UNARY_OF_CLIENT(rpc, executor)                                               \
  grpc::ServerUnaryReactor* rpc(grpc::CallbackServerContext* call,                         \
                                const v1::rpc##Request* request, v1::rpc##Response* reply) \
      override {                                                                           \
    return RunUnary({context_, call, context_->executor, #rpc, request, reply},            \
                    [=, client = OriginOf(*call).client](HandlerContext& of) {             \
                      return pleat::rpc(of, client, *request, reply);                      \
                    });                                                                    \
  }

// A method `rpc` that answers with a stream.
#define PLEAT_SERVER_STREAM(rpc)                                                               \
  grpc::ServerWriteReactor<v1::rpc##Response>* rpc(grpc::CallbackServerContext* call,          \
                                                   const v1::rpc##Request* request) override { \
    return StartAdmitted<grpc::ServerWriteReactor<v1::rpc##Response>>(                         \
        context_, *call, #rpc, [&](HandlerContext* of) { return pleat::rpc(of, *request); });  \
  }

namespace pleat {
namespace {

class SequenceServiceImpl final : public v1::SequenceService::CallbackService {
 public:
  explicit SequenceServiceImpl(HandlerContext* context) : context_(context) {}
  PLEAT_UNARY(QueryUpload, storage_executor)
  PLEAT_UNARY(GetSequence, storage_executor)
  PLEAT_UNARY(ListSequences, storage_executor)
  PLEAT_UNARY(DeleteSequence, storage_executor)
  PLEAT_UNARY(PinSequence, storage_executor)
  PLEAT_UNARY(DeleteUpload, storage_executor)
  grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
      grpc::CallbackServerContext* call, v1::UploadSequenceResponse* response) override {
    return StartAdmitted<grpc::ServerReadReactor<v1::UploadSequenceRequest>>(
        context_, *call, "UploadSequence",
        [&](HandlerContext* of) { return pleat::UploadSequence(of, response); });
  }
  PLEAT_SERVER_STREAM(DownloadSequence)

 private:
  HandlerContext* context_;
};

class JobServiceImpl final : public v1::JobService::CallbackService {
 public:
  explicit JobServiceImpl(HandlerContext* context) : context_(context) {}
  PLEAT_UNARY_OF_CLIENT(CreateTrainingJob, storage_executor)
  PLEAT_UNARY_OF_CLIENT(CreateCompressionJob, storage_executor)
  PLEAT_UNARY(GetJob, storage_executor)
  PLEAT_UNARY(ListJobs, storage_executor)
  PLEAT_UNARY(CancelJob, storage_executor)
  PLEAT_UNARY(DeleteJob, storage_executor)
  PLEAT_SERVER_STREAM(WatchJob)

 private:
  HandlerContext* context_;
};

class ModelServiceImpl final : public v1::ModelService::CallbackService {
 public:
  explicit ModelServiceImpl(HandlerContext* context) : context_(context) {}
  PLEAT_UNARY(GetModel, storage_executor)
  PLEAT_UNARY(ListModels, storage_executor)
  PLEAT_UNARY(DeleteModel, storage_executor)
  PLEAT_UNARY(PinModel, storage_executor)
  PLEAT_SERVER_STREAM(DownloadModel)

 private:
  HandlerContext* context_;
};

class CompressedSequenceServiceImpl final : public v1::CompressedSequenceService::CallbackService {
 public:
  explicit CompressedSequenceServiceImpl(HandlerContext* context) : context_(context) {}
  PLEAT_UNARY(GetCompressedSequence, storage_executor)
  PLEAT_UNARY(ListCompressedSequences, storage_executor)
  PLEAT_UNARY(DeleteCompressedSequence, storage_executor)
  PLEAT_UNARY(PinCompressedSequence, storage_executor)
  grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadCompressedSequence(
      grpc::CallbackServerContext* call, v1::UploadCompressedSequenceResponse* response) override {
    return StartAdmitted<grpc::ServerReadReactor<v1::UploadSequenceRequest>>(
        context_, *call, "UploadCompressedSequence",
        [&](HandlerContext* of) { return pleat::UploadCompressedSequence(of, response); });
  }
  PLEAT_SERVER_STREAM(DownloadCompressedSequence)
  PLEAT_SERVER_STREAM(DecodeFrames)

 private:
  HandlerContext* context_;
};

class PoseServiceImpl final : public v1::PoseService::CallbackService {
 public:
  explicit PoseServiceImpl(HandlerContext* context) : context_(context) {}
  PLEAT_UNARY(GetStreamHeader, pose_executor)
  PLEAT_UNARY(EvaluatePose, pose_executor)
  PLEAT_SERVER_STREAM(EvaluateClip)
  grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>* LiveSession(
      grpc::CallbackServerContext* call) override {
    return StartAdmitted<grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>>(
        context_, *call, "LiveSession",
        [&](HandlerContext* of) { return pleat::LiveSession(of, call); });
  }

 private:
  HandlerContext* context_;
};

}  // namespace

std::unique_ptr<grpc::Service> MakeSequenceService(HandlerContext* context) {
  return std::make_unique<SequenceServiceImpl>(context);
}
std::unique_ptr<grpc::Service> MakeJobService(HandlerContext* context) {
  return std::make_unique<JobServiceImpl>(context);
}
std::unique_ptr<grpc::Service> MakeModelService(HandlerContext* context) {
  return std::make_unique<ModelServiceImpl>(context);
}
std::unique_ptr<grpc::Service> MakeCompressedSequenceService(HandlerContext* context) {
  return std::make_unique<CompressedSequenceServiceImpl>(context);
}
std::unique_ptr<grpc::Service> MakePoseService(HandlerContext* context) {
  return std::make_unique<PoseServiceImpl>(context);
}

}  // namespace pleat
