// Attacks a real pleatd, one attack after the other, and prints a table: what was done, the largest
// memory of the server, how long a live session at 30 fps waited for its frames meanwhile, and
// whether anything that was acknowledged is lost.
//
//   attacks [--seconds N] [--memory-mb M] [--only NAME]
//
// Exit code 1 when the memory exceeded --memory-bytes by more than kBesideBytes, when anything was
// lost, or when the server ended.
#include <grpcpp/grpcpp.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "attack.h"
#include "pleat/performer/performer.h"
#include "server/daemon.h"
#include "support/temporary_folder.h"

namespace pleat {

Attack::Attack(const AttackedServer& server, std::string address)
    : server_(server), address_(std::move(address)) {}

std::shared_ptr<grpc::Channel> Attack::NewChannel() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetMaxSendMessageSize(-1);
  return grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments);
}

std::unique_ptr<RemoteCharacterService> Attack::Connect() const {
  auto client = RemoteCharacterService::Connect(address_);
  return client.ok() ? *std::move(client) : nullptr;
}

void Attack::Start(int num_threads, std::function<void(int)> attacker) {
  for (int i = 0; i < num_threads; ++i) threads_.emplace_back(attacker, i);
}

void Attack::End() {
  if (!over_.HasBeenNotified()) over_.Notify();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void Attack::Acknowledged(const std::string& sequence_id) {
  std::lock_guard lock(mutex_);
  if (sequence_id[0] == '-') {
    acknowledged_.erase(sequence_id.substr(1));
  } else {
    acknowledged_.insert(sequence_id);
  }
}

std::set<std::string> Attack::acknowledged() const {
  std::lock_guard lock(mutex_);
  return acknowledged_;
}

namespace {

// What the process takes beside what --memory-bytes counts: the program, its threads, what the
// allocator keeps, and gRPC while it reads (docs/reliability.md).
constexpr uint64_t kBesideBytes = uint64_t{192} << 20;

struct Row {
  std::string attack, load;
  uint64_t num_calls = 0, peak_bytes = 0;
  double p50_ms = 0, p99_ms = 0;
  int num_frames = 0, num_lost = 0;
  bool survived = true;
  bool is_good(uint64_t memory_bytes) const {
    return survived && num_lost == 0 && peak_bytes <= memory_bytes + kBesideBytes;
  }
};

std::vector<std::string> Flags(const AttackedServer& server) {
  return {"--data-dir",      server.data_dir,
          "--listen",        "127.0.0.1:0",
          "--memory-bytes",  std::to_string(server.memory_bytes),
          "--reserve-bytes", "1MB",
          "--log-level",     "off"};
}

// One frame after the other at 30 fps, as an artist has them.
std::vector<double> UseMeanwhile(const Attack& attack) {
  std::vector<double> waits_ms;
  const auto client = attack.Connect();
  if (client == nullptr) return waits_ms;
  ClipQuery character;
  character.model_id = attack.server().model_id;
  const auto session =
      client->poses().OpenLiveSession(character, {.latest_wins = true, .decode = false});
  if (!session.ok()) return waits_ms;
  const std::vector<Pose>& poses = attack.server().poses;
  LiveFrame frame;
  for (uint64_t number = 0; attack.Pause(1. / 30); ++number) {
    const absl::Time sent = absl::Now();
    if (!(*session)->Send(number, poses[number % poses.size()]).ok()) break;
    if (!(*session)->Receive(&frame).ok() && (*session)->ended()) break;
    waits_ms.push_back(absl::ToDoubleMilliseconds(absl::Now() - sent));
  }
  return waits_ms;
}

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return -1;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(q * static_cast<double>(values.size() - 1))];
}

// Everything that was acknowledged must be there, and whole.
int CountLost(RemoteCharacterService* client, const std::set<std::string>& acknowledged) {
  int num_lost = 0;
  for (const std::string& id : acknowledged) {
    const auto status = client->sequences().QueryUpload(id);
    num_lost += !status.ok() || !status->complete;
  }
  return num_lost;
}

Row Run(const AttackedServer& server, const AttackKind& kind) {
  Row row{.attack = kind.name, .load = kind.load};
  Daemon daemon(Flags(server));
  const std::string address = daemon.WaitForAddress();
  Attack attack(server, address);
  std::vector<double> waits_ms;
  {
    Attack bystander(server, address);
    std::thread using_it([&] { waits_ms = UseMeanwhile(bystander); });
    kind.start(&attack);
    attack.Pause(server.seconds);
    attack.End();
    bystander.End();
    using_it.join();
  }
  row.num_calls = attack.num_calls();
  row.num_frames = static_cast<int>(waits_ms.size());
  row.p50_ms = Quantile(waits_ms, .5);
  row.p99_ms = Quantile(waits_ms, .99);
  const auto client = attack.Connect();
  row.survived = client != nullptr;
  if (client != nullptr) row.num_lost = CountLost(client.get(), attack.acknowledged());
  row.peak_bytes = daemon.PeakBytes();
  if (client != nullptr) {
    for (const std::string& id : attack.acknowledged()) {
      client->sequences().Delete(id).IgnoreError();
    }
  }
  daemon.Signal(SIGTERM);
  row.survived = daemon.Wait() == 0 && row.survived;
  return row;
}

// A character to ask for frames.
absl::Status Prepare(AttackedServer* server) {
  const auto performer = GeneratePerformer({.num_frames = 40, .num_vertices = 2000}, {});
  if (!performer.ok()) return performer.status();
  server->poses = performer->truth.track.poses();
  Daemon daemon(Flags(*server));
  const auto client = RemoteCharacterService::Connect(daemon.WaitForAddress());
  if (!client.ok()) return client.status();
  const auto sequence = (*client)->sequences().Upload(performer->sequence, {});
  if (!sequence.ok()) return sequence.status();
  const auto job = (*client)->jobs().CreateTraining({.sequence_ids = {sequence->id}});
  if (!job.ok()) return job.status();
  absl::Status status = WatchJob((*client)->jobs(), job->id, [&](const JobInfo& info) {
    server->model_id = info.result_id;
    return true;
  });
  daemon.Signal(SIGTERM);
  daemon.Wait();
  return server->model_id.empty() ? absl::InternalError("the training failed") : status;
}

int Main(const AttackedServer& options, const std::string& only) {
  TemporaryFolder folder;
  AttackedServer server = options;
  server.data_dir = folder.path();
  if (const absl::Status status = Prepare(&server); !status.ok()) {
    std::fprintf(stderr, "%s\n", status.ToString().c_str());
    return 1;
  }
  std::printf("--memory-bytes %d MB, allowed beside it %d MB, %.0f s for each attack\n\n",
              static_cast<int>(server.memory_bytes >> 20), static_cast<int>(kBesideBytes >> 20),
              server.seconds);
  std::printf(
      "| attack | load | calls | largest RSS, MB | bystander's frames: p50 / p99, ms | lost |\n");
  std::printf("|---|---|---|---|---|---|\n");
  bool is_good = true;
  for (const AttackKind& kind : AttackKinds()) {
    if (!only.empty() && only != kind.name) continue;
    const Row row = Run(server, kind);
    const std::string waits =
        row.num_frames == 0 ? "no frame" : absl::StrFormat("%.1f / %.1f", row.p50_ms, row.p99_ms);
    std::printf("| %s | %s | %d | %d | %d: %s | %s |\n", row.attack.c_str(), row.load.c_str(),
                static_cast<int>(row.num_calls), static_cast<int>(row.peak_bytes >> 20),
                row.num_frames, waits.c_str(),
                row.survived ? std::to_string(row.num_lost).c_str() : "the server");
    std::fflush(stdout);
    is_good = row.is_good(server.memory_bytes) && is_good;
  }
  std::printf("\n%s\n", is_good ? "nothing lost, memory within its bounds" : "NOT GOOD");
  return is_good ? 0 : 1;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  signal(SIGPIPE, SIG_IGN);
  pleat::AttackedServer server{.memory_bytes = uint64_t{512} << 20};
  std::string only;
  for (int i = 1; i + 1 < argc; i += 2) {
    int megabytes = 0;
    if (std::strcmp(argv[i], "--memory-mb") == 0 && absl::SimpleAtoi(argv[i + 1], &megabytes)) {
      server.memory_bytes = static_cast<uint64_t>(megabytes) << 20;
    } else if (std::strcmp(argv[i], "--only") == 0) {
      only = argv[i + 1];
    } else if (std::strcmp(argv[i], "--seconds") != 0 ||
               !absl::SimpleAtod(argv[i + 1], &server.seconds)) {
      std::fprintf(stderr, "usage: attacks [--seconds N] [--memory-mb M] [--only NAME]\n");
      return 2;
    }
  }
  return pleat::Main(server, only);
}
