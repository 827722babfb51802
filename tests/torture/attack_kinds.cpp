// What strangers do to a server. Everything here is allowed to fail: being refused is the point.
#include <arpa/inet.h>
#include <grpcpp/grpcpp.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "attack.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "pleat/wire/skeleton_messages.h"
#include "support/fake_training.h"
#include "support/random_data.h"

namespace pleat {
namespace {

// A sequence that nobody has, of about `megabytes`.
MeshSequence NewSequence(int megabytes, uint64_t seed) {
  constexpr int kVertices = 4096;
  Random random(seed);
  std::vector<Eigen::Matrix3Xf> frames(static_cast<size_t>(megabytes) * 1'000'000 /
                                       (12 * kVertices));
  for (Eigen::Matrix3Xf& frame : frames) {
    frame.resize(3, kVertices);
    for (Eigen::Index i = 0; i < frame.size(); ++i) {
      frame(i) = static_cast<float>(random.Uniform());
    }
  }
  std::vector<int32_t> corners(kVertices), sizes(kVertices / 4, 4);
  for (int i = 0; i < kVertices; ++i) corners[static_cast<size_t>(i)] = i;
  Topology topology = Topology::Create(kVertices, corners, sizes).value();
  return MeshSequence::Create(std::move(topology), std::move(frames), {}).value();
}

v1::EvaluateClipRequest ClipRequest(const Attack& attack, int num_poses) {
  v1::EvaluateClipRequest request;
  request.mutable_character()->set_model_id(attack.server().model_id);
  request.mutable_track()->set_fps(30);
  const std::vector<Pose>& poses = attack.server().poses;
  for (int i = 0; i < num_poses; ++i) {
    *request.mutable_track()->add_poses() = ToProto(poses[static_cast<size_t>(i) % poses.size()]);
  }
  return request;
}

// Streams that are opened and never read.
void UnreadClips(Attack* attack) {
  attack->Start(4, [attack](int) {
    const v1::EvaluateClipRequest request = ClipRequest(*attack, 5000);
    const auto channel = attack->NewChannel();
    const auto stub = v1::PoseService::NewStub(channel);
    std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
    std::vector<std::unique_ptr<grpc::ClientReader<v1::EvaluateClipResponse>>> readers;
    while (attack->Pause(.01)) {
      if (contexts.size() == 60) {
        for (const auto& context : contexts) context->TryCancel();
        for (const auto& reader : readers) reader->Finish();
        readers.clear();
        contexts.clear();
      }
      contexts.push_back(std::make_unique<grpc::ClientContext>());
      readers.push_back(stub->EvaluateClip(contexts.back().get(), request));
      attack->CountLoad();
    }
    for (const auto& context : contexts) context->TryCancel();
    for (const auto& reader : readers) reader->Finish();
  });
}

void UnreadDownloads(Attack* attack) {
  attack->Start(4, [attack](int) {
    const auto channel = attack->NewChannel();
    const auto stub = v1::ModelService::NewStub(channel);
    v1::DownloadModelRequest request;
    request.set_id(attack->server().model_id);
    std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
    std::vector<std::unique_ptr<grpc::ClientReader<v1::DownloadModelResponse>>> readers;
    while (attack->Pause(.01) && contexts.size() < 120) {
      contexts.push_back(std::make_unique<grpc::ClientContext>());
      readers.push_back(stub->DownloadModel(contexts.back().get(), request));
      attack->CountLoad();
    }
    while (attack->Pause(1)) {
    }
    for (const auto& context : contexts) context->TryCancel();
    for (const auto& reader : readers) reader->Finish();
  });
}

// Uploads whose checks come together, of which each takes several times its size.
void Uploads(Attack* attack) {
  attack->Start(6, [attack](int number) {
    const auto client = attack->Connect();
    if (client == nullptr) return;
    for (uint64_t round = 0; !attack->over(); ++round) {
      const auto info = client->sequences().Upload(
          NewSequence(24, 1000 * static_cast<uint64_t>(number) + round), {});
      attack->CountLoad();
      if (!info.ok()) continue;
      attack->Acknowledged(info->id);
      if (round % 2 == 1) continue;
      client->sequences().Delete(info->id).IgnoreError();
      attack->Acknowledged("-" + info->id);
    }
  });
}

// Requests as large as messages may be, many at once.
void LargeRequests(Attack* attack) {
  attack->Start(16, [attack](int) {
    v1::CreateTrainingJobRequest request;
    request.set_rig(std::string(15 << 20, '{'));
    while (!attack->over()) {
      const auto stub = v1::JobService::NewStub(attack->NewChannel());
      grpc::ClientContext context;
      v1::CreateTrainingJobResponse response;
      stub->CreateTrainingJob(&context, request, &response);
      attack->CountLoad();
    }
  });
}

// Two bytes on the wire are an object in memory.
void HollowRequests(Attack* attack) {
  attack->Start(8, [attack](int) {
    v1::EvaluatePoseRequest request;
    for (int i = 0; i < 300'000; ++i) request.add_poses();
    const auto stub = v1::PoseService::NewStub(attack->NewChannel());
    while (!attack->over()) {
      grpc::ClientContext context;
      v1::EvaluatePoseResponse response;
      stub->EvaluatePose(&context, request, &response);
      attack->CountLoad();
    }
  });
}

// Pieces of uploads that are larger than pieces may be.
void LargePieces(Attack* attack) {
  attack->Start(24, [attack](int) {
    v1::UploadSequenceRequest piece;
    piece.set_data(std::string(15 << 20, 'x'));
    const auto stub = v1::SequenceService::NewStub(attack->NewChannel());
    while (!attack->over()) {
      grpc::ClientContext context;
      v1::UploadSequenceResponse response;
      const auto writer = stub->UploadSequence(&context, &response);
      while (writer->Write(piece)) {
      }
      writer->Finish();
      attack->CountLoad();
    }
  });
}

void CompressedMessages(Attack* attack) {
  attack->Start(2, [attack](int) {
    v1::CreateTrainingJobRequest request;
    request.set_rig(std::string(200 << 20, '\0'));
    const auto stub = v1::JobService::NewStub(attack->NewChannel());
    while (!attack->over()) {
      grpc::ClientContext context;
      context.set_compression_algorithm(GRPC_COMPRESS_GZIP);
      v1::CreateTrainingJobResponse response;
      stub->CreateTrainingJob(&context, request, &response);
      attack->CountLoad();
    }
  });
}

// Sessions that send poses and read nothing.
void IdleSessions(Attack* attack) {
  attack->Start(4, [attack](int) {
    const auto channel = attack->NewChannel();
    const auto stub = v1::PoseService::NewStub(channel);
    std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
    std::vector<
        std::unique_ptr<grpc::ClientReaderWriter<v1::LiveSessionRequest, v1::LiveSessionResponse>>>
        streams;
    while (attack->Pause(.005) && contexts.size() < 100) {
      contexts.push_back(std::make_unique<grpc::ClientContext>());
      streams.push_back(stub->LiveSession(contexts.back().get()));
      v1::LiveSessionRequest start;
      start.mutable_start()->mutable_character()->set_model_id(attack->server().model_id);
      start.mutable_start()->set_max_in_flight(64);
      streams.back()->Write(start);
      attack->CountLoad();
    }
    v1::LiveSessionRequest pose;
    *pose.mutable_pose()->mutable_pose() = ToProto(attack->server().poses[0]);
    for (auto& stream : streams) {
      for (int i = 0; i < 8; ++i) stream->Write(pose);
    }
    while (attack->Pause(1)) {
    }
    for (const auto& context : contexts) context->TryCancel();
    for (const auto& stream : streams) stream->Finish();
  });
}

// Sockets that are opened and say nothing.
void SilentConnections(Attack* attack) {
  attack->Start(2, [attack](int) {
    sockaddr_in address{};
    int port = 0;
    if (!absl::SimpleAtoi(attack->address().substr(attack->address().rfind(':') + 1), &port))
      return;
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::vector<int> sockets;
    while (!attack->over()) {
      if (sockets.size() > 800 || !attack->Pause(.0005)) {
        for (const int fd : sockets) close(fd);
        sockets.clear();
      }
      const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (fd < 0) continue;
      sockets.push_back(fd);
      connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
      attack->CountLoad();
    }
    for (const int fd : sockets) close(fd);
  });
}

// Jobs without end, most of them cancelled.
void JobFlood(Attack* attack) {
  attack->Start(4, [attack](int number) {
    const auto client = attack->Connect();
    if (client == nullptr) return;
    const auto info =
        client->sequences().Upload(MakeSwayingTube(5, "flood " + std::to_string(number)), {});
    if (!info.ok()) return;
    attack->Acknowledged(info->id);
    for (int i = 0; !attack->over(); ++i) {
      const auto job = client->jobs().CreateCompression({.sequence_id = info->id});
      attack->CountLoad();
      if (job.ok() && i % 3 != 0) client->jobs().Cancel(job->id).IgnoreError();
    }
  });
}

void Nothing(Attack*) {}

}  // namespace

const std::vector<AttackKind>& AttackKinds() {
  static const std::vector<AttackKind> kinds = {
      {"none", "", Nothing},
      {"clips that nobody reads", "4 x 60 clips of 5,000 poses", UnreadClips},
      {"downloads that nobody reads", "480 streams", UnreadDownloads},
      {"uploads that end together", "6 writers of 24 MB", Uploads},
      {"large requests", "16 at once, 15 MB each", LargeRequests},
      {"hollow requests", "8 at once, 300,000 empty poses each", HollowRequests},
      {"large pieces of uploads", "24 streams, 15 MB a piece", LargePieces},
      {"compressed messages", "200 MB of zeros in 200 kB", CompressedMessages},
      {"live sessions that nobody reads", "400 sessions", IdleSessions},
      {"silent connections", "1,600 sockets, again and again", SilentConnections},
      {"jobs without end", "4 clients", JobFlood},
  };
  return kinds;
}

}  // namespace pleat
