#include "options.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <sstream>

#include "machine_memory.h"
#include "pleat/base/status.h"
#include "pleat/identity/token_file.h"
#include "pleat/local/retention_flags.h"

namespace pleat {
namespace {

constexpr double kScrubHours = 7 * 24;

void AddServiceFlags(CLI::App* app, LocalServiceOptions* service, double* scrub_hours) {
  app->add_option("--data-dir", service->data_dir, "Folder that keeps sequences, jobs and models")
      ->required();
  app->add_option("--workers", service->num_workers, "Jobs that run at the same time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app->add_option("--max-queued-jobs-per-client", service->max_queued_jobs_per_client,
                  "Jobs of one token, or of one address of callers without tokens, that may wait")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app->add_option("--threads-per-job", service->num_threads_per_job, "0 = one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->add_option("--pose-threads", service->num_pose_threads, "0 = one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->add_option("--max-batch", service->max_batch,
                  "Live poses of one model that are evaluated together; 1 = none")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  MemoryLimits* memory = &service->memory;
  app->add_option("--memory-bytes", memory->memory_bytes,
                  "Memory for everything: models, decoders, encoders, uploads, streams, requests "
                  "and jobs (e.g. 8GB) [three quarters of this machine's or container's]")
      ->transform(CLI::AsSizeValue(false));
  app->add_option("--cache-bytes", memory->cache_bytes, "Of this, for models (e.g. 2GB)")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--decode-bytes", memory->decode_bytes,
                  "Of this, for decoding compressed sequences, all calls together")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--reserve-bytes", service->reserve_bytes, "Kept free on the disk")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--scrub-hours", *scrub_hours,
                  "Time in which every stored file is read and verified once; 0 = never")
      ->check(CLI::Range(0., 8760.))
      ->capture_default_str();
  ServiceLimits* limits = &service->limits;
  app->add_option("--max-upload-bytes", limits->max_upload_bytes, "Largest sequence file")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--max-vertices", limits->max_vertices, "Most vertices of a mesh")
      ->check(CLI::Range(1, 4'000'000))
      ->capture_default_str();
  app->add_option("--max-frames", limits->max_frames, "Most frames of a sequence or clip")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
}

void AddProjectFlags(CLI::App* app, ProjectLimits* project) {
  app->add_option("--project-bytes", project->max_bytes,
                  "Stored files of one project (pleat token create --project); 0 = no limit")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--project-queued-jobs", project->max_queued_jobs,
                  "Jobs of one project that may wait; 0 = no limit")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app->add_option("--project-frames-per-second", project->frames_per_second,
                  "Frames that one project may have evaluated or decoded; 0 = no limit")
      ->check(CLI::Range(0., 1e9))
      ->capture_default_str();
  app->add_option("--project-job-cpu-seconds-per-hour", project->job_cpu_seconds_per_hour,
                  "Processor time that the jobs of one project may use; 0 = no limit")
      ->check(CLI::Range(0., 1e9))
      ->capture_default_str();
  app->add_flag("--share-content", project->share_content,
                "End an upload at once when another project has the same content; whoever knows "
                "the SHA-256 of a file can then have it");
}

constexpr double kSweepSeconds = 60;

void AddRetentionFlags(CLI::App* app, RetentionFlags* flags) {
  VisitRetentionFlags(
      *flags, 1, [app](const char* flag, auto& value, const char* help, double least, double most) {
        app->add_option(flag, value, help)->check(CLI::Range(least, most))->capture_default_str();
      });
}

void AddNetworkFlags(CLI::App* app, GrpcServerOptions* grpc) {
  app->add_option("--listen", grpc->listen,
                  "HOST:PORT or unix:PATH; port 0 = any free one, printed at the start")
      ->capture_default_str();
  app->add_option("--max-message-bytes", grpc->max_receive_bytes, "Largest message from a client")
      ->check(CLI::Range(64 << 10, 256 << 20))
      ->capture_default_str();
  app->add_option("--max-open-streams", grpc->max_open_streams,
                  "Uploads, downloads, watches, clips and live sessions together")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app->add_option("--max-streams-per-client", grpc->max_streams_per_client,
                  "Of these, for one token, or for one address of callers without tokens")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app->add_option("--request-bytes", grpc->request_bytes,
                  "Of all memory, for requests such as the poses of clips")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  app->add_option("--max-connections", grpc->connections.max_connections, "Of all clients together")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app->add_option("--max-connections-per-peer", grpc->connections.max_connections_per_peer,
                  "Of one address")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app->add_option("--max-connection-idle-seconds", grpc->connections.max_idle_seconds,
                  "A connection without calls is closed after this")
      ->check(CLI::Range(1., 1e6))
      ->capture_default_str();
  app->add_option("--max-connection-age-seconds", grpc->connections.max_age_seconds,
                  "An older connection takes no more calls; 0 = for ever")
      ->check(CLI::Range(0., 1e6))
      ->capture_default_str();
  app->add_option("--max-connection-age-grace-seconds", grpc->connections.max_age_grace_seconds,
                  "How long its calls may go on then")
      ->check(CLI::Range(0., 1e6))
      ->capture_default_str();
  app->add_option("--tls-cert", grpc->tls.certificate,
                  "PEM file with the server's certificate chain")
      ->check(CLI::ExistingFile);
  app->add_option("--tls-key", grpc->tls.key, "PEM file with its private key")
      ->check(CLI::ExistingFile);
  app->add_option("--tls-client-ca", grpc->tls.client_ca,
                  "PEM file with the authority of client certificates; then each client needs one")
      ->check(CLI::ExistingFile);
}

void AddStudioFlags(CLI::App* app, ServerOptions* options) {
  StudioOptions* const studio = &options->studio;
  CLI::Option* const http = app->add_option(
      "--http", studio->listen,
      "HOST:PORT that serves the studio, Pleat in a browser, in plain text; port 0 = any "
      "free one, printed at the start [nobody is served]");
  app->add_option("--http-host", studio->hosts,
                  "A further name under which browsers reach it, such as studio.example.com behind "
                  "a proxy; may be repeated");
  app->add_option("--share", options->shared_model,
                  "Id of a model: whoever opens the studio without a token sees it and the "
                  "sequences that it was trained on, nothing else, and can change nothing")
      ->needs(http);
}

// What the studio takes from the other flags.
void CompleteStudio(ServerOptions* options) {
  options->studio.limits = options->service.limits;
  options->studio.scratch_dir = options->service.data_dir + "/studio-uploads";
  options->studio.version = PLEAT_VERSION;
}

void AddAccessFlags(CLI::App* app, ServerOptions* options) {
  app->add_option("--token-file", options->token_file,
                  "Tokens of 'pleat token'; as soon as there is one, each call needs one "
                  "[DATA/tokens.json]");
  app->add_option("--audit-log", options->audit_log,
                  "File that receives a line about each call that changes something, gives away "
                  "content or is refused");
  app->add_flag(
      "--allow-unencrypted", options->exposure.allow_unencrypted,
      "Let other machines connect without TLS: whoever can listen on the network sees all");
  app->add_flag("--allow-anonymous", options->exposure.allow_anonymous,
                "Let other machines connect without a token or a certificate");
  app->add_flag("--allow-root", options->exposure.allow_root,
                "Let other machines connect to a server that runs as root");
}

// Whether others may reach the server as the flags ask (exposure.h).
absl::Status CheckAccess(ServerOptions* options) {
  Exposure& exposure = options->exposure;
  exposure.listen = options->grpc.listen;
  exposure.encrypted = !options->grpc.tls.certificate.empty();
  exposure.is_root = geteuid() == 0;
  PLEAT_ASSIGN_OR_RETURN(const std::vector<Token> tokens, ReadTokens(options->token_file));
  exposure.knows_callers = !options->grpc.tls.client_ca.empty() || !tokens.empty();
  PLEAT_RETURN_IF_ERROR(CheckExposure(exposure));
  if (options->studio.listen.empty()) return absl::OkStatus();
  // Browsers show no certificates here, and nothing is encrypted.
  Exposure pages = exposure;
  pages.listen = options->studio.listen;
  pages.encrypted = false;
  // Whoever opens a shared page without a token sees what is shared and no more.
  pages.knows_callers = !tokens.empty() || !options->shared_model.empty();
  return CheckExposure(pages);
}

}  // namespace

CommandLine ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  line.options.grpc.listen = "127.0.0.1:7320";
  line.options.studio.listen.clear();
  line.options.service.memory.memory_bytes = MachineMemoryBytes() / 4 * 3;
  CLI::App app("pleatd: trains animated characters and streams their frames over gRPC.", "pleatd");
  app.set_version_flag("--version", PLEAT_VERSION);
  AddNetworkFlags(&app, &line.options.grpc);
  double scrub_hours = kScrubHours;
  AddServiceFlags(&app, &line.options.service, &scrub_hours);
  AddProjectFlags(&app, &line.options.service.project);
  RetentionFlags retention;
  AddRetentionFlags(&app, &retention);
  std::string job_priority = "idle";
  app.add_option("--job-priority", job_priority,
                 "idle: jobs take the processor time that live sessions and other programs leave; "
                 "normal: they take their share")
      ->check(CLI::IsMember({"idle", "normal"}))
      ->capture_default_str();
  app.add_option("--drain-seconds", line.options.drain_seconds,
                 "How long running calls may go on after SIGTERM")
      ->check(CLI::Range(0, 3600))
      ->capture_default_str();
  AddAccessFlags(&app, &line.options);
  AddStudioFlags(&app, &line.options);
  app.add_option("--metrics-listen", line.options.metrics_listen,
                 "HOST:PORT that answers GET /metrics for Prometheus, in plain text");
  app.add_option("--slow-call-seconds", line.options.slow_call_seconds,
                 "A call that is no stream and takes longer is a warning in the log")
      ->check(CLI::Range(0., 3600.))
      ->capture_default_str();
  app.add_option("--log-level", line.options.logging.level,
                 "trace, debug, info, warning, error or off")
      ->capture_default_str();
  app.add_flag("--log-json", line.options.logging.json, "Log JSON, one object per line");
  std::ostringstream out;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    line.exit = true;
    line.exit_code = app.exit(error, out, out) == 0 ? 0 : 2;
    line.message = out.str();
    return line;
  }
  line.options.service.scrub_seconds = 3600 * scrub_hours;
  line.options.service.sweep_seconds = kSweepSeconds;
  line.options.service.retention = RulesOf(retention);
  line.options.service.jobs_in_idle_time = job_priority == "idle";
  CompleteStudio(&line.options);
  if (line.options.token_file.empty()) {
    line.options.token_file = TokenPath(line.options.service.data_dir);
  }
  if (const absl::Status status = CheckAccess(&line.options); !status.ok()) {
    line.exit = true;
    line.exit_code = 2;
    line.message = std::string(status.message()) + "\n";
  }
  return line;
}

}  // namespace pleat
