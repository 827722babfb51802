// One function per unary RPC, each in its own file: convert, call, convert. No gRPC here.
#pragma once

#include "absl/status/status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/v1/compressed_sequence_service.pb.h"
#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/model_service.pb.h"
#include "pleat/v1/pose_service.pb.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {

absl::Status QueryUpload(HandlerContext& context, const v1::QueryUploadRequest& request,
                         v1::QueryUploadResponse* response);
absl::Status GetSequence(HandlerContext& context, const v1::GetSequenceRequest& request,
                         v1::GetSequenceResponse* response);
absl::Status ListSequences(HandlerContext& context, const v1::ListSequencesRequest& request,
                           v1::ListSequencesResponse* response);
absl::Status DeleteSequence(HandlerContext& context, const v1::DeleteSequenceRequest& request,
                            v1::DeleteSequenceResponse* response);
absl::Status PinSequence(HandlerContext& context, const v1::PinSequenceRequest& request,
                         v1::PinSequenceResponse* response);
absl::Status DeleteUpload(HandlerContext& context, const v1::DeleteUploadRequest& request,
                          v1::DeleteUploadResponse* response);

// client: who asks (CallOrigin).
absl::Status CreateTrainingJob(HandlerContext& context, const std::string& client,
                               const v1::CreateTrainingJobRequest& request,
                               v1::CreateTrainingJobResponse* response);
absl::Status CreateCompressionJob(HandlerContext& context, const std::string& client,
                                  const v1::CreateCompressionJobRequest& request,
                                  v1::CreateCompressionJobResponse* response);
absl::Status GetJob(HandlerContext& context, const v1::GetJobRequest& request,
                    v1::GetJobResponse* response);
absl::Status ListJobs(HandlerContext& context, const v1::ListJobsRequest& request,
                      v1::ListJobsResponse* response);
absl::Status CancelJob(HandlerContext& context, const v1::CancelJobRequest& request,
                       v1::CancelJobResponse* response);
absl::Status DeleteJob(HandlerContext& context, const v1::DeleteJobRequest& request,
                       v1::DeleteJobResponse* response);

absl::Status GetModel(HandlerContext& context, const v1::GetModelRequest& request,
                      v1::GetModelResponse* response);
absl::Status ListModels(HandlerContext& context, const v1::ListModelsRequest& request,
                        v1::ListModelsResponse* response);
absl::Status DeleteModel(HandlerContext& context, const v1::DeleteModelRequest& request,
                         v1::DeleteModelResponse* response);
absl::Status PinModel(HandlerContext& context, const v1::PinModelRequest& request,
                      v1::PinModelResponse* response);

absl::Status GetCompressedSequence(HandlerContext& context,
                                   const v1::GetCompressedSequenceRequest& request,
                                   v1::GetCompressedSequenceResponse* response);
absl::Status ListCompressedSequences(HandlerContext& context,
                                     const v1::ListCompressedSequencesRequest& request,
                                     v1::ListCompressedSequencesResponse* response);
absl::Status DeleteCompressedSequence(HandlerContext& context,
                                      const v1::DeleteCompressedSequenceRequest& request,
                                      v1::DeleteCompressedSequenceResponse* response);
absl::Status PinCompressedSequence(HandlerContext& context,
                                   const v1::PinCompressedSequenceRequest& request,
                                   v1::PinCompressedSequenceResponse* response);

absl::Status GetStreamHeader(HandlerContext& context, const v1::GetStreamHeaderRequest& request,
                             v1::GetStreamHeaderResponse* response);
absl::Status EvaluatePose(HandlerContext& context, const v1::EvaluatePoseRequest& request,
                          v1::EvaluatePoseResponse* response);

}  // namespace pleat
