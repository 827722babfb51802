// What training does to an artist: a live session at 30 fps on a server that rests, and on the same
// server while every worker trains, over a socket of this machine. Both are measured in one run, so
// that their ratio says something on a machine that does other work as well.
//
//   live_beside_jobs [SECONDS OF EACH MEASUREMENT]
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "cli/load/load_report.h"
#include "cli/load/load_run.h"
#include "pleat/base/status.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/performer/performer.h"
#include "pleat/remote/remote_character_service.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

constexpr int kVertices = 10'000;
constexpr int kFrames = 60;

struct Waits {
  double p50_ms = 0, p99_ms = 0;
  int num_frames = 0;
};

class Studio {
 public:
  // One worker for each core, and one thread for each job: all cores train.
  absl::Status Open(bool jobs_in_idle_time) {
    const int num_cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    PLEAT_ASSIGN_OR_RETURN(service_,
                           LocalCharacterService::Open({.data_dir = folder_.path(),
                                                        .num_workers = num_cores,
                                                        .num_threads_per_job = 1,
                                                        .jobs_in_idle_time = jobs_in_idle_time}));
    PLEAT_ASSIGN_OR_RETURN(
        server_,
        GrpcServer::Start(service_.get(), {.pose_executor = service_->poses().executor()}));
    PLEAT_ASSIGN_OR_RETURN(
        client_, RemoteCharacterService::Connect(absl::StrCat("127.0.0.1:", server_->port())));
    num_workers_ = num_cores;
    return TrainModel();
  }

  absl::StatusOr<Waits> Measure(double seconds) {
    LoadOptions load;
    load.seconds = seconds;
    ClipQuery character;
    character.model_id = model_id_;
    PLEAT_ASSIGN_OR_RETURN(const LoadResult result, RunLoad(client_->poses(), character, poses_,
                                                            load, [] { return false; }));
    std::vector<double> latency_ms;
    for (const LoadSample& sample : result.clients.at(0)) latency_ms.push_back(sample.latency_ms);
    std::sort(latency_ms.begin(), latency_ms.end());
    if (latency_ms.empty()) return absl::InternalError("no frame came");
    return Waits{Percentile(latency_ms, 50), Percentile(latency_ms, 99),
                 static_cast<int>(latency_ms.size())};
  }

  // Returns when every worker trains, which they do for much longer than a measurement.
  absl::Status StartJobs() {
    for (int i = 0; i < num_workers_; ++i) {
      TrainOptions options{.learner = LearnerChoice::kSgplvm, .iterations = 10'000};
      options.seed = static_cast<uint64_t>(i + 2);
      PLEAT_ASSIGN_OR_RETURN(
          const JobInfo job,
          client_->jobs().CreateTraining({.sequence_ids = {sequence_id_}, .options = options}));
      jobs_.push_back(job.id);
    }
    for (const std::string& id : jobs_) {
      PLEAT_RETURN_IF_ERROR(WatchJob(client_->jobs(), id, [](const JobInfo& job) {
        return job.fraction < .05;  // behind the reading of the clip
      }));
    }
    return absl::OkStatus();
  }
  absl::Status EndJobs() {
    for (const std::string& id : jobs_) PLEAT_RETURN_IF_ERROR(client_->jobs().Cancel(id));
    return absl::OkStatus();
  }

 private:
  absl::Status TrainModel() {
    PLEAT_ASSIGN_OR_RETURN(const Performer performer, GeneratePerformer({.num_frames = kFrames,
                                                                         .num_vertices = kVertices,
                                                                         .frame_rate = {30, 1}}));
    poses_ = performer.truth.track.poses();
    PLEAT_ASSIGN_OR_RETURN(const SequenceInfo sequence,
                           client_->sequences().Upload(performer.sequence, {}));
    sequence_id_ = sequence.id;
    PLEAT_ASSIGN_OR_RETURN(
        const JobInfo job,
        client_->jobs().CreateTraining(
            {.sequence_ids = {sequence_id_}, .options = {.learner = LearnerChoice::kRegional}}));
    return WatchJob(client_->jobs(), job.id, [&](const JobInfo& info) {
      model_id_ = info.result_id;
      return true;
    });
  }

  TemporaryFolder folder_;
  std::unique_ptr<LocalCharacterService> service_;
  std::unique_ptr<GrpcServer> server_;
  std::unique_ptr<RemoteCharacterService> client_;
  std::string sequence_id_, model_id_;
  std::vector<Pose> poses_;
  std::vector<std::string> jobs_;
  int num_workers_ = 0;
};

absl::Status MeasurePriority(const char* priority, double seconds) {
  Studio studio;
  PLEAT_RETURN_IF_ERROR(studio.Open(std::string(priority) == "idle"));
  PLEAT_ASSIGN_OR_RETURN(const Waits resting, studio.Measure(seconds));
  PLEAT_RETURN_IF_ERROR(studio.StartJobs());
  PLEAT_ASSIGN_OR_RETURN(const Waits training, studio.Measure(seconds));
  PLEAT_RETURN_IF_ERROR(studio.EndJobs());
  std::printf("| %s | %.2f / %.2f | %.2f / %.2f | %.2f / %.2f | %d, %d |\n", priority,
              resting.p50_ms, resting.p99_ms, training.p50_ms, training.p99_ms,
              training.p50_ms / resting.p50_ms, training.p99_ms / resting.p99_ms,
              resting.num_frames, training.num_frames);
  std::fflush(stdout);
  return absl::OkStatus();
}

int Main(double seconds) {
  std::printf("| --job-priority | resting, p50 / p99 ms | training | ratio | frames |\n");
  std::printf("|---|---|---|---|---|\n");
  for (const char* priority : {"idle", "normal"}) {
    if (const absl::Status status = MeasurePriority(priority, seconds); !status.ok()) {
      std::fprintf(stderr, "%s\n", status.ToString().c_str());
      return 1;
    }
  }
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  double seconds = 20;
  if (argc > 2 || (argc == 2 && !absl::SimpleAtod(argv[1], &seconds))) {
    std::fprintf(stderr, "usage: live_beside_jobs [SECONDS OF EACH MEASUREMENT]\n");
    return 2;
  }
  return pleat::Main(seconds);
}
