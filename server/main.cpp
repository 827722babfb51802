// pleatd: the Pleat server. Exit codes: 0 ended by a signal, 1 cannot run, 2 wrong command line.
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "call_observers.h"
#include "options.h"
#include "pleat/base/status.h"
#include "pleat/metrics/server_metrics.h"
#include "pleat/service/shared_service.h"
#include "service_gauges.h"

namespace pleat {
namespace {

int Fail(const absl::Status& status) {
  spdlog::error("pleatd cannot run: {}", std::string(status.message()));
  return 1;
}

std::string Address(const GrpcServerOptions& options, int port) {
  const size_t colon = options.listen.rfind(':');
  if (port == 0 || colon == std::string::npos) return options.listen;
  return options.listen.substr(0, colon + 1) + std::to_string(port);
}

// As many file descriptors as the system allows: every connection takes two.
void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

// An empty address means that nobody is answered.
absl::Status ServeMetrics(const std::string& address, LocalCharacterService* service,
                          const GrpcServer* server, ServerMetrics* metrics) {
  AddServiceGauges(service, metrics);
  AddNetworkGauges(server, metrics);
  if (address.empty()) return absl::OkStatus();
  const absl::Status status = metrics->Serve(address);
  if (status.ok()) spdlog::info("metrics at http://{}/metrics", address);
  return status;
}

// Null when no pages are asked for. shared_model: its id, or empty.
absl::StatusOr<std::unique_ptr<StudioServer>> ServeStudio(StudioOptions options,
                                                          const std::string& shared_model,
                                                          LocalCharacterService* service,
                                                          GrpcServer* server) {
  if (options.listen.empty()) return nullptr;
  if (!shared_model.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.shared,
                           WithContext("--share", ContentOfModel(service, shared_model)));
  }
  options.memory = &service->memory().all;
  absl::StatusOr<std::unique_ptr<StudioServer>> studio =
      StudioServer::Start(std::move(options), server);
  if (studio.ok()) {
    // As the address of gRPC below.
    std::printf("studio at http://%s/\n", (*studio)->address().c_str());
    spdlog::info("studio at http://{}/", (*studio)->address());
  }
  return studio;
}

// Every thread blocks these signals, so that only sigwait sees them.
sigset_t BlockSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

absl::StatusOr<std::unique_ptr<LocalCharacterService>> OpenService(LocalServiceOptions options,
                                                                   ServerMetrics* metrics) {
  options.on_problem = [](const std::string& problem) { spdlog::error("{}", problem); };
  options.on_job_state = LogJob;
  options.on_job_stage = [metrics](const std::string& stage, double seconds) {
    metrics->JobStage(stage, seconds);
  };
  options.on_removed = [](const std::string& sentence) { spdlog::info("{}", sentence); };
  return LocalCharacterService::Open(std::move(options));
}

int Run(const ServerOptions& options) {
  if (const absl::Status status = ConfigureLogging(options.logging); !status.ok()) {
    std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
    return 2;
  }
  RaiseDescriptorLimit();
  const sigset_t signals = BlockSignals();
  ServerMetrics metrics;
  absl::StatusOr<std::unique_ptr<LocalCharacterService>> service =
      OpenService(options.service, &metrics);
  if (!service.ok()) return Fail(service.status());
  absl::StatusOr<std::unique_ptr<TokenRegistry>> tokens = OpenTokens(options.token_file);
  if (!tokens.ok()) return Fail(tokens.status());
  absl::StatusOr<std::unique_ptr<AuditLog>> audit_log = OpenAuditLog(options.audit_log);
  if (!audit_log.ok()) return Fail(audit_log.status());
  const CallListener calls =
      ObserveCalls(&metrics, audit_log->get(), tokens->get(), options.slow_call_seconds);
  GrpcServerOptions grpc = options.grpc;
  grpc.pose_executor = (*service)->poses().executor();
  grpc.memory = &(*service)->memory().all;
  grpc.call_listener = &calls;
  grpc.tokens = tokens->get();
  grpc.of_project = [&service](const std::string& project) {
    return &(*service)->OfProject(project);
  };
  grpc.probe = [&service] { return (*service)->ProbeDisk(); };
  absl::StatusOr<std::unique_ptr<GrpcServer>> server = GrpcServer::Start(service->get(), grpc);
  if (!server.ok()) return Fail(server.status());
  WarnBeforeExpiry((*server)->certificate_expiry());
  if (const absl::Status status =
          ServeMetrics(options.metrics_listen, service->get(), server->get(), &metrics);
      !status.ok()) {
    return Fail(status);
  }
  const absl::StatusOr<std::unique_ptr<StudioServer>> studio =
      ServeStudio(options.studio, options.shared_model, service->get(), server->get());
  if (!studio.ok()) return Fail(studio.status());
  const std::string address = Address(options.grpc, (*server)->port());
  // This line goes to standard output, so that a script can wait for it and read the port.
  std::printf("listening on %s\n", address.c_str());
  std::fflush(stdout);
  spdlog::info("pleatd {} listening on {}, data in {}, {} workers", PLEAT_VERSION, address,
               options.service.data_dir, options.service.num_workers);

  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("signal {}: shutting down, running calls have {} s", signal, options.drain_seconds);
  // A second signal ends the process the hard way.
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  (*service)->Shutdown();  // jobs are queued again, their watchers end
  spdlog::info("jobs have stopped");
  if (*studio != nullptr) (*studio)->Shutdown();
  (*server)->Shutdown(options.drain_seconds);
  metrics.StopServing();
  spdlog::info("pleatd has ended");
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  const pleat::CommandLine line = pleat::ParseCommandLine(argc, argv);
  if (line.exit) {
    std::fputs(line.message.c_str(), line.exit_code == 0 ? stdout : stderr);
    return line.exit_code;
  }
  return pleat::Run(line.options);
}
