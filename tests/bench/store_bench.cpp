// Lists of many jobs, in pages, over a socket on this machine.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/store/catalog.h"
#include "pleat/store/records.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

constexpr int kNumJobs = 50'000;
constexpr int kPageSize = 500;

// A server with many jobs that have ended, made once.
struct ServerWithJobs {
  TemporaryFolder folder;
  std::unique_ptr<LocalCharacterService> service;
  std::unique_ptr<GrpcServer> server;
  std::unique_ptr<RemoteCharacterService> client;
  std::string last_token;  // of the last page

  ServerWithJobs() {
    {
      const auto catalog = Catalog::Open(CatalogPath(folder.path())).value();
      std::vector<CatalogEntry> rows;
      for (int i = 0; i < kNumJobs; ++i) {
        JobInfo job;
        job.id = absl::StrFormat("job-%012d", i);
        job.state = JobState::kSucceeded;
        job.sequence_ids = {std::string(64, 'a')};
        job.name = "walk";
        job.result_id = std::string(64, 'b');
        rows.push_back({job.id, EncodeRecord(job), 1});
        rows.back().job.state = JobStateName(job.state);
      }
      catalog->PutAll(EntryKind::kJob, rows).IgnoreError();
    }
    service = LocalCharacterService::Open({.data_dir = folder.path()}).value();
    server = GrpcServer::Start(service.get(), {}).value();
    client = RemoteCharacterService::Connect("127.0.0.1:" + std::to_string(server->port())).value();
    for (std::string token;; last_token = token) {
      token = client->jobs().ListPage({kPageSize, token})->next_token;
      if (token.empty()) break;
    }
  }
};

ServerWithJobs& TheServer() {
  static ServerWithJobs server;
  return server;
}

void ListOnePage(benchmark::State& state, bool is_last) {
  ServerWithJobs& server = TheServer();
  const std::string token = is_last ? server.last_token : std::string();
  for (auto _ : state) {
    if (server.client->jobs().ListPage({kPageSize, token})->items.size() != kPageSize) {
      state.SkipWithError("the page is not whole");
    }
  }
}
BENCHMARK_CAPTURE(ListOnePage, first, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(ListOnePage, last, true)->Unit(benchmark::kMillisecond)->UseRealTime();

void ListAllJobs(benchmark::State& state) {
  ServerWithJobs& server = TheServer();
  for (auto _ : state) {
    if (server.client->jobs().List()->size() != kNumJobs) {
      state.SkipWithError("the list is not whole");
    }
  }
}
BENCHMARK(ListAllJobs)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace pleat
