// One function per streaming RPC, each in its own file. What it gives belongs to gRPC
// (call_reactor.h).
#pragma once

#include <grpcpp/support/server_callback.h>

#include "pleat/reactors/handler_context.h"
#include "pleat/v1/compressed_sequence_service.pb.h"
#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/model_service.pb.h"
#include "pleat/v1/pose_service.pb.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
    HandlerContext* context, v1::UploadSequenceResponse* response);
grpc::ServerWriteReactor<v1::DownloadSequenceResponse>* DownloadSequence(
    HandlerContext* context, const v1::DownloadSequenceRequest& request);
grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(HandlerContext* context,
                                                         const v1::WatchJobRequest& request);
grpc::ServerWriteReactor<v1::DownloadModelResponse>* DownloadModel(
    HandlerContext* context, const v1::DownloadModelRequest& request);
grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadCompressedSequence(
    HandlerContext* context, v1::UploadCompressedSequenceResponse* response);
grpc::ServerWriteReactor<v1::DownloadCompressedSequenceResponse>* DownloadCompressedSequence(
    HandlerContext* context, const v1::DownloadCompressedSequenceRequest& request);
grpc::ServerWriteReactor<v1::DecodeFramesResponse>* DecodeFrames(
    HandlerContext* context, const v1::DecodeFramesRequest& request);
grpc::ServerWriteReactor<v1::EvaluateClipResponse>* EvaluateClip(
    HandlerContext* context, const v1::EvaluateClipRequest& request);
grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>* LiveSession(
    HandlerContext* context, grpc::CallbackServerContext* call);

}  // namespace pleat
