// One pose query from request to frame: evaluation, encoding, and both over a socket on this
// machine. The character has about 10,000 vertices, trained on a made-up performance.
#include <benchmark/benchmark.h>

#include "pleat/character/train_character.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/performer/performer.h"
#include "pleat/remote/remote_character_service.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

// A server with one model, made once.
struct Setup {
  TemporaryFolder folder;
  std::unique_ptr<LocalCharacterService> service;
  std::unique_ptr<GrpcServer> server;
  std::unique_ptr<RemoteCharacterService> client;
  std::shared_ptr<const CharacterModel> model;
  ClipQuery query;

  Setup() {
    const Performer performer =
        GeneratePerformer({.num_frames = 60, .num_vertices = 10'000, .frame_rate = {30, 1}})
            .value();
    service = LocalCharacterService::Open({.data_dir = folder.path()}).value();
    server = GrpcServer::Start(service.get(), {}).value();
    client = RemoteCharacterService::Connect("127.0.0.1:" + std::to_string(server->port())).value();
    TrainOptions options;
    options.learner = LearnerChoice::kGp;
    const std::string sequence_id = client->sequences().Upload(performer.sequence, {})->id;
    const std::string job_id =
        client->jobs().CreateTraining({.sequence_ids = {sequence_id}, .options = options})->id;
    const absl::Status watched = WatchJob(client->jobs(), job_id, [&](const JobInfo& job) {
      query.model_id = job.result_id;
      return true;
    });
    if (watched.ok()) model = service->models().Acquire(query.model_id).value();
    query.track = performer.truth.track;
  }
};

Setup& TheSetup() {
  static Setup setup;
  return setup;
}

void Evaluate(benchmark::State& state, bool skinned_only) {
  Setup& setup = TheSetup();
  PoseEvaluator evaluator(setup.model);
  const std::vector<Pose>& poses = setup.query.track.poses();
  EvaluatedFrame frame;
  size_t t = 1;
  for (auto _ : state) {
    t = t + 1 < poses.size() ? t + 1 : 1;
    benchmark::DoNotOptimize(skinned_only
                                 ? evaluator.EvaluateSkinned(poses[t], {}, &frame)
                                 : evaluator.Evaluate({&poses[t], &poses[t - 1]}, {}, &frame));
  }
}
BENCHMARK_CAPTURE(Evaluate, skinned, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Evaluate, hybrid, false)->Unit(benchmark::kMillisecond);

void EvaluateAndEncode(benchmark::State& state, FrameEncoding encoding) {
  Setup& setup = TheSetup();
  const auto session =
      LocalPoseSession::Open(setup.model, {.encoder = {.encoding = encoding}}).value();
  const std::vector<Pose>& poses = setup.query.track.poses();
  size_t t = 0;
  for (auto _ : state) {
    t = (t + 1) % poses.size();
    benchmark::DoNotOptimize(session->Show({&poses[t], &poses[t > 0 ? t - 1 : t]}));
  }
}
BENCHMARK_CAPTURE(EvaluateAndEncode, mesh, FrameEncoding::kDracoMesh)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(EvaluateAndEncode, points, FrameEncoding::kDracoPointCloud)
    ->Unit(benchmark::kMillisecond);

// Pose out, frame back and decoded.
void LiveRoundTrip(benchmark::State& state) {
  Setup& setup = TheSetup();
  const auto session = setup.client->poses().OpenLiveSession(setup.query).value();
  const std::vector<Pose>& poses = setup.query.track.poses();
  LiveFrame frame;
  size_t t = 0;
  for (auto _ : state) {
    t = (t + 1) % poses.size();
    if (!session->Send(t, poses[t], {}, t == 0).ok() || !session->Receive(&frame).ok()) {
      state.SkipWithError("the session broke");
      return;
    }
  }
}
BENCHMARK(LiveRoundTrip)->Unit(benchmark::kMillisecond)->UseRealTime();

// Frames per second of a clip stream, decoded.
void ClipStream(benchmark::State& state) {
  Setup& setup = TheSetup();
  for (auto _ : state) {
    const absl::Status status = setup.client->poses().EvaluateClip(
        setup.query, [](int, const EvaluatedFrame&) { return absl::OkStatus(); });
    if (!status.ok()) state.SkipWithError(std::string(status.message()).c_str());
  }
  state.SetItemsProcessed(state.iterations() * setup.query.track.num_frames());
}
BENCHMARK(ClipStream)->Unit(benchmark::kMillisecond)->UseRealTime();

void SmallCall(benchmark::State& state) {
  Setup& setup = TheSetup();
  for (auto _ : state) benchmark::DoNotOptimize(setup.client->models().Get(setup.query.model_id));
}
BENCHMARK(SmallCall)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace pleat
