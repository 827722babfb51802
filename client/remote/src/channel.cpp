#include "channel.h"

#include <grpcpp/completion_queue.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/wire/limit_messages.h"
#include "token_interceptor.h"

namespace pleat {
namespace {

// The header of a large character, with its vertex order and topology, exceeds the default of 4
// MiB.
constexpr int kMaxReceiveBytes = 64 << 20;
constexpr int kKeepaliveMs = 120'000;
constexpr int kLiveLookaheadBytes = 65536;
constexpr auto kProbeTime = std::chrono::seconds(1);
// grpc.health.v1.HealthCheckResponse with its field 1, the status, SERVING.
constexpr std::string_view kServing = "\x08\x01";
constexpr auto kPoll = std::chrono::milliseconds(50);

// When the server cannot be reached, gRPC repeats the calls that may be repeated without harm.
// Creating a job is not one of them.
constexpr char kServiceConfig[] = R"({"methodConfig":[{"name":[
  {"service":"pleat.v1.SequenceService"},{"service":"pleat.v1.ModelService"},
  {"service":"pleat.v1.PoseService"},{"service":"pleat.v1.CompressedSequenceService"},
  {"service":"pleat.v1.JobService","method":"GetJob"},
  {"service":"pleat.v1.JobService","method":"ListJobs"}],
  "retryPolicy":{"maxAttempts":4,"initialBackoff":"0.1s","maxBackoff":"2s",
  "backoffMultiplier":2,"retryableStatusCodes":["UNAVAILABLE"]}}]})";

std::chrono::milliseconds BackOffTime(int attempt) {
  return std::chrono::milliseconds(std::min(100 << std::min(attempt, 6), 4000));
}

// False when `progress` was cancelled meanwhile.
bool Wait(std::chrono::milliseconds time, const Progress& progress) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    if (progress.cancelled()) return false;
    std::this_thread::sleep_for(std::min(kPoll, time));
  }
  return true;
}

std::shared_ptr<grpc::ChannelCredentials> MakeCredentials(const RemoteOptions& options) {
  if (!options.tls) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = options.tls_root_certificates;
  tls.pem_cert_chain = options.tls_client_certificate;
  tls.pem_private_key = options.tls_client_key;
  return grpc::SslCredentials(tls);
}

}  // namespace

grpc::Status AskForHealth(const std::shared_ptr<grpc::Channel>& channel, const std::string& service,
                          bool* serving) {
  grpc::GenericStub stub(channel);
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kProbeTime);
  // grpc.health.v1.HealthCheckRequest with its field 1, the name, which has less than 128 bytes.
  const grpc::Slice name(
      service.empty()
          ? ""
          : absl::StrCat("\x0a", std::string(1, static_cast<char>(service.size())), service));
  grpc::ByteBuffer request(&name, 1), response;
  grpc::Status status;
  const auto call =
      stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
  call->StartCall();
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  grpc::Slice answer;
  *serving =
      status.ok() && response.DumpToSingleSlice(&answer).ok() &&
      std::string_view(reinterpret_cast<const char*>(answer.begin()), answer.size()) == kServing;
  return status;
}

namespace {

absl::Status NoConnection(const std::string& address, const RemoteOptions& options,
                          const std::string& reason) {
  if (absl::StrContains(reason, "andshake")) {
    return absl::UnavailableError(absl::StrCat(
        "no encrypted connection with '", address, "': its certificate must be signed by ",
        options.tls_root_certificates.empty() ? "an authority of this system" : "that of --tls-ca",
        " and name this address, and it must speak TLS (", reason, ")"));
  }
  return absl::UnavailableError(absl::StrCat("no Pleat server answers at '", address,
                                             "'; start one with `pleatd` or name another",
                                             options.tls ? "" : " (does it want --tls?)"));
}

}  // namespace

absl::Status WaitForConnection(const std::shared_ptr<grpc::Channel>& channel,
                               const std::string& address, const RemoteOptions& options) {
  const auto deadline =
      std::chrono::system_clock::now() +
      std::chrono::milliseconds(static_cast<int64_t>(options.connect_seconds * 1000));
  std::string reason;
  grpc_connectivity_state state = channel->GetState(true);
  while (state != GRPC_CHANNEL_READY) {
    if (state == GRPC_CHANNEL_TRANSIENT_FAILURE) {
      bool serving = false;
      reason = AskForHealth(channel, "", &serving).error_message();
      if (options.tls && absl::StrContains(reason, "andshake")) break;  // waiting will not help
    }
    if (!channel->WaitForStateChange(state, deadline)) break;
    state = channel->GetState(true);
  }
  if (channel->GetState(false) == GRPC_CHANNEL_READY) return absl::OkStatus();
  return NoConnection(address, options, reason);
}

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address, const RemoteOptions& options,
                                           ChannelUse use) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  arguments.SetServiceConfigJSON(kServiceConfig);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2000);
  // Otherwise channels with equal arguments would share one connection and its flow-control
  // windows.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  // Without the probe, windows do not grow with the bandwidth, and small ones keep the transport
  // from buffering many frames that nobody has read.
  if (use == ChannelUse::kLive) {
    arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
    arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLiveLookaheadBytes);
  }
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> interceptors;
  if (!options.token.empty()) interceptors.push_back(ShowToken(options.token));
  return grpc::experimental::CreateCustomChannelWithInterceptors(
      address, MakeCredentials(options), arguments, std::move(interceptors));
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  return WithLimitDetails(
      absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message()),
      status.error_details());
}

std::optional<absl::Duration> RetryDelayOf(const absl::Status& status) {
  const std::optional<LimitRefusal> refusal = LimitRefusalOf(status);
  return refusal ? refusal->retry_after : std::nullopt;
}

bool WaitForRetry(const absl::Status& status, int attempt, const RemoteOptions& options,
                  const Progress& progress) {
  const std::optional<absl::Duration> delay = RetryDelayOf(status);
  if (!delay || attempt >= options.max_attempts ||
      *delay > absl::Seconds(options.max_retry_seconds)) {
    return false;
  }
  return Wait(std::max(BackOffTime(attempt), absl::ToChronoMilliseconds(*delay)), progress);
}

bool IsTransient(const absl::Status& status) {
  return status.code() == absl::StatusCode::kUnavailable ||
         status.code() == absl::StatusCode::kAborted;
}

bool BackOff(int attempt, const Progress& progress) { return Wait(BackOffTime(attempt), progress); }

CancelWatcher::CancelWatcher(grpc::ClientContext* context, const Progress& progress)
    : thread_([this, context, progress] {
        while (!done_) {
          if (progress.cancelled()) {
            context->TryCancel();
            return;
          }
          std::this_thread::sleep_for(kPoll);
        }
      }) {}

CancelWatcher::~CancelWatcher() {
  done_ = true;
  thread_.join();
}

}  // namespace pleat
