// Verbs that talk to a server whose answers a test has written down.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "client/remote/scripted_server.h"
#include "client/tube_files.h"
#include "pleat/base/sha256.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

class ScriptedVerbTest : public testing::Test {
 protected:
  Outcome Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--server", server_.address()});
    return RunPleat(arguments);
  }

  // Every sequence is taken.
  void TakeUploads() {
    ON_CALL(server_.sequences, QueryUpload)
        .WillByDefault(testing::Return(grpc::Status::OK));  // nothing is there yet
    ON_CALL(server_.sequences, UploadSequence)
        .WillByDefault([](grpc::ServerContext*, grpc::ServerReader<v1::UploadSequenceRequest>* in,
                          v1::UploadSequenceResponse* out) {
          SequenceInfo info;
          info.num_frames = TubeFiles::kNumFrames;
          info.num_vertices = TubeFiles::kNumVertices;
          for (v1::UploadSequenceRequest part; in->Read(&part);) {
            if (part.has_header()) info.id = part.header().id();
          }
          *out->mutable_sequence() = ToProto(info);
          return grpc::Status::OK;
        });
  }
  // The model of the tube is there, under `id`.
  void ServeModel(const std::string& id) {
    ModelInfo info;
    info.id = id;
    info.skeleton = files_.model().skeleton();
    info.num_vertices = TubeFiles::kNumVertices;
    ON_CALL(server_.models, ListModels).WillByDefault([info](auto*, auto*, auto* response) {
      *response->add_models() = ToProto(info);
      return grpc::Status::OK;
    });
    ON_CALL(server_.models, GetModel).WillByDefault([info](auto*, auto* request, auto* response) {
      EXPECT_EQ(request->id(), info.id);
      *response->mutable_model() = ToProto(info);
      return grpc::Status::OK;
    });
  }
  // Downloads of any model or compressed sequence give `bytes`.
  void ServeDownloads(const std::string& bytes) {
    const auto send = [bytes](auto* out, auto part) {
      part.set_size_bytes(bytes.size());
      part.set_data(bytes);
      out->Write(part);
      return grpc::Status::OK;
    };
    ON_CALL(server_.models, DownloadModel).WillByDefault([send](auto*, auto*, auto* out) {
      return send(out, v1::DownloadModelResponse());
    });
    ON_CALL(server_.compressed, DownloadCompressedSequence)
        .WillByDefault([send](auto*, auto*, auto* out) {
          return send(out, v1::DownloadCompressedSequenceResponse());
        });
  }
  // The service has these jobs, and each can be watched.
  void ServeJobs(const std::vector<JobInfo>& jobs) {
    ON_CALL(server_.jobs, ListJobs).WillByDefault([jobs](auto*, auto*, auto* response) {
      for (const JobInfo& job : jobs) *response->add_jobs() = ToProto(job);
      return grpc::Status::OK;
    });
    ON_CALL(server_.jobs, WatchJob).WillByDefault([jobs](auto*, auto* request, auto* out) {
      for (const JobInfo& job : jobs) {
        if (job.id != request->id()) continue;
        v1::WatchJobResponse response;
        *response.mutable_job() = ToProto(job);
        out->Write(response);
      }
      return grpc::Status::OK;
    });
  }
  static JobInfo Job(const std::string& id, JobState state = JobState::kQueued) {
    JobInfo job;
    job.id = id;
    job.state = state;
    return job;
  }

  const TubeFiles files_;
  ScriptedServer server_;
};

}  // namespace pleat
