#include "pleat/grpc/grpc_server.h"

#include <grpc/compression.h>
#include <grpc/support/log.h>
#include <grpcpp/channel.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "call_listening.h"
#include "certificate_check.h"
#include "channel_gateway.h"
#include "connection_listener.h"
#include "health_watch.h"
#include "pleat/base/status.h"
#include "pleat/reactors/admission.h"
#include "pleat/service/shared_service.h"
#include "revocation_watch.h"
#include "services.h"
#include "tls_version.h"

namespace pleat {
namespace {

constexpr int kKeepaliveMs = 60'000;         // between two questions to an idle connection
constexpr int kKeepaliveTimeoutMs = 20'000;  // until it must have answered
constexpr int kHandshakeMs = 10'000;         // of TLS and HTTP/2 together
// What gRPC may use for connections, calls and messages that are not parsed yet: a part of all
// memory, within these bounds. gRPC itself sees to it (grpc::ResourceQuota).
constexpr uint64_t kMessageShare = 8;
constexpr uint64_t kMinMessageBytes = uint64_t{32} << 20, kMaxMessageBytes = uint64_t{1} << 30;
// How long a live session that drains may take to get rid of the frame that is being written.
constexpr auto kSlowReaderTime = std::chrono::seconds(1);
constexpr auto kCloseTime = std::chrono::milliseconds(100);

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeCredentials(const TlsFiles& files) {
  if (files.certificate.empty() != files.key.empty()) {
    return absl::InvalidArgumentError("TLS needs both a certificate and its key");
  }
  if (files.certificate.empty()) {
    if (!files.client_ca.empty()) {
      return absl::InvalidArgumentError("client certificates need TLS: give certificate and key");
    }
    return grpc::InsecureServerCredentials();
  }
  PLEAT_RETURN_IF_ERROR(CheckCertificateFiles(files.certificate, files.key, files.client_ca));
  PLEAT_RETURN_IF_ERROR(RequireTls13());
  grpc::experimental::TlsServerCredentialsOptions tls(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
          files.key, files.certificate, files.client_ca, files.reload_seconds));
  tls.watch_identity_key_cert_pairs();
  if (!files.client_ca.empty()) {
    tls.watch_root_certs();
    tls.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(tls);
}

// gRPC 1.51 inflates a compressed message before it looks at its size: 14 MiB become 11 GB. So
// nothing is inflated at all, and calls that announce compressed messages end with UNIMPLEMENTED.
void RefuseCompression(grpc::ServerBuilder* builder) {
  builder->AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder->SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
}

int Milliseconds(double seconds) { return static_cast<int>(std::min(seconds, 2e6) * 1000); }

void LimitAge(const ConnectionLimits& limits, grpc::ServerBuilder* builder) {
  builder->AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS,
                              Milliseconds(limits.max_idle_seconds));
  if (limits.max_age_seconds <= 0) return;
  builder->AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS, Milliseconds(limits.max_age_seconds));
  builder->AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS,
                              Milliseconds(limits.max_age_grace_seconds));
}

void LogForGrpc(gpr_log_func_args* args) {
  const auto level = args->severity == GPR_LOG_SEVERITY_ERROR  ? spdlog::level::warn
                     : args->severity == GPR_LOG_SEVERITY_INFO ? spdlog::level::debug
                                                               : spdlog::level::trace;
  spdlog::log(level, "grpc: {}", args->message);
}

class GrpcServerImpl final : public GrpcServer {
 public:
  GrpcServerImpl(CharacterService* service, const GrpcServerOptions& options)
      : certificate_(options.tls.certificate),
        request_memory_(options.request_bytes, "--request-bytes", options.memory),
        stream_memory_(UINT64_MAX, "--memory-bytes", options.memory),
        storage_executor_(options.num_storage_threads),
        transfer_executor_(options.num_transfer_threads) {
    if (options.pose_executor == nullptr) own_pose_executor_.emplace(0);
    SetServices(service, &context_);
    context_.pose_executor = own_pose_executor_ ? &*own_pose_executor_ : options.pose_executor;
    context_.storage_executor = &storage_executor_;
    context_.transfer_executor = &transfer_executor_;
    context_.calls->request_memory = &request_memory_;
    context_.calls->stream_memory = &stream_memory_;
    context_.calls->max_open_streams = options.max_open_streams;
    context_.calls->max_streams_per_client = options.max_streams_per_client;
    context_.calls->tokens = options.tokens;
    if (options.call_listener != nullptr) {
      context_.calls->on_frame_step = options.call_listener->on_frame_step;
    }
    if (options.of_project) {
      context_.calls->of_project = [this,
                                    of_project = options.of_project](const std::string& project) {
        return ContextOf(project, of_project);
      };
    }
    context_.calls->of_share = [this](HandlerContext* all, const std::string& ids) {
      return ContextOfShare(all, ids);
    };
    services_.push_back(MakeSequenceService(&context_));
    services_.push_back(MakeJobService(&context_));
    services_.push_back(MakeModelService(&context_));
    services_.push_back(MakeCompressedSequenceService(&context_));
    services_.push_back(MakePoseService(&context_));
  }
  ~GrpcServerImpl() override { Shutdown(0); }

  absl::Status Bind(const GrpcServerOptions& options) {
    gpr_set_log_function(&LogForGrpc);
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<grpc::ServerCredentials> credentials,
                           MakeCredentials(options.tls));
    grpc::ServerBuilder builder;
    PLEAT_ASSIGN_OR_RETURN(listener_,
                           ConnectionListener::Open(options.listen, options.connections));
    port_ = listener_->port();
    acceptor_ = builder.experimental().AddExternalConnectionAcceptor(
        grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD, credentials);
    PLEAT_RETURN_IF_ERROR(LimitMessages(options.memory, &builder));
    builder.SetMaxReceiveMessageSize(options.max_receive_bytes);
    RefuseCompression(&builder);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, options.max_streams_per_connection);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
    LimitAge(options.connections, &builder);
    builder.experimental().SetInterceptorCreators(
        MakeCallListening(options.call_listener, &context_.calls->running_calls));
    for (const auto& service : services_) builder.RegisterService(service.get());
    server_ = builder.BuildAndStart();
    if (server_ == nullptr) {
      return absl::UnavailableError("gRPC does not start; its reason is in the log");
    }
    listener_->Start(
        [this](int fd) {
          grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
          connection.listener_fd = -1;
          connection.fd = fd;
          acceptor_->HandleNewConnection(&connection);
        },
        [](const std::string& what) { spdlog::warn("{}", what); });
    // The messages of this server, whose sizes have been checked where they were made.
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    gateway_ = MakeChannelGateway(server_->InProcessChannel(arguments));
    health_.emplace(server_->GetHealthCheckService(), options.probe);
    if (options.tokens != nullptr)
      revocation_.emplace(options.tokens, &context_.calls->running_calls);
    return absl::OkStatus();
  }

  int port() const override { return port_; }
  MemoryUse memory_use() const override {
    return {request_memory_.used_bytes(), stream_memory_.used_bytes(), message_memory_.bytes()};
  }
  int num_connections() const override { return listener_->num_open(); }
  std::optional<int64_t> certificate_expiry() const override {
    if (certificate_.empty()) return std::nullopt;
    return CertificateFileExpiry(certificate_);
  }
  uint64_t num_refused_connections() const override { return listener_->num_refused(); }

  CallGateway& gateway() override { return *gateway_; }
  absl::StatusOr<AdmittedServices> Admit(const ForeignCaller& caller, const char* rpc) override {
    PLEAT_ASSIGN_OR_RETURN(HandlerContext* const of,
                           AdmitToken(&context_, caller.token, caller.shared, rpc));
    return AdmittedServices{.models = of->models, .poses = of->poses};
  }

  std::shared_ptr<grpc::Channel> InProcessChannel() override {
    return server_->InProcessChannel(grpc::ChannelArguments());
  }

  void Shutdown(double drain_seconds) override {
    std::lock_guard lock(shutdown_mutex_);
    if (server_ == nullptr) return;
    revocation_.reset();
    health_.reset();
    context_.calls->draining = true;
    if (auto* health = server_->GetHealthCheckService()) health->Shutdown();
    context_.calls->live_sessions.DrainAll();
    WaitForCalls(drain_seconds);
    listener_->Stop();
    // gRPC's own draining would also wait for idle clients to notice, which takes them seconds.
    server_->Shutdown(std::chrono::system_clock::now() + kCloseTime);
    server_->Wait();
    // A task whose call has ended may still own its reactor, which refers to the context.
    context_.calls->open_calls.WaitUntilNone();
    server_.reset();
  }

 private:
  static void SetServices(CharacterService* service, HandlerContext* context) {
    context->sequences = &service->sequences();
    context->jobs = &service->jobs();
    context->models = &service->models();
    context->poses = &service->poses();
    context->compressed_sequences = &service->compressed_sequences();
  }

  // Projects come from good tokens alone, so there are no more than operators have made.
  HandlerContext* ContextOf(const std::string& project, const ServicesOfProject& of_project) {
    std::lock_guard lock(contexts_mutex_);
    std::unique_ptr<HandlerContext>& context = contexts_[project];
    if (context == nullptr) {
      context = std::make_unique<HandlerContext>(context_);  // with the same calls and threads
      context->project = project;
      SetServices(of_project(project), context.get());
    }
    return context.get();
  }

  // Shares come from flags of this process alone, so there are few.
  HandlerContext* ContextOfShare(HandlerContext* all, const std::string& ids) {
    std::lock_guard lock(contexts_mutex_);
    Share& share = shares_[{all, ids}];
    if (share.context == nullptr) {
      share.service = MakeSharedService({.sequences = all->sequences,
                                         .jobs = all->jobs,
                                         .models = all->models,
                                         .poses = all->poses},
                                        absl::StrSplit(ids, ','));
      share.context = std::make_unique<HandlerContext>(*all);
      SetServices(share.service.get(), share.context.get());
    }
    return share.context.get();
  }

  // The share of gRPC is taken for as long as the server lives.
  absl::Status LimitMessages(MemoryBudget* memory, grpc::ServerBuilder* builder) {
    uint64_t bytes = kMaxMessageBytes;
    if (memory != nullptr) {
      bytes = std::clamp(memory->capacity_bytes() / kMessageShare, kMinMessageBytes, bytes);
      PLEAT_ASSIGN_OR_RETURN(message_memory_, memory->Reserve(bytes, "gRPC"));
    }
    grpc::ResourceQuota quota("pleatd");
    builder->SetResourceQuota(quota.Resize(bytes));
    return absl::OkStatus();
  }

  // Waits until all calls have ended or their time is over. Live sessions have less time: they have
  // been told to end, and the client of one that still goes on after kSlowReaderTime does not read.
  void WaitForCalls(double drain_seconds) {
    const auto start = std::chrono::steady_clock::now();
    const auto deadline =
        start + std::chrono::microseconds(static_cast<int64_t>(drain_seconds * 1e6));
    const auto patience = start + kSlowReaderTime;
    if (context_.calls->open_calls.WaitUntilNone(std::min(deadline, patience)) ||
        deadline <= patience) {
      return;
    }
    context_.calls->live_sessions.AbandonAll();
    context_.calls->open_calls.WaitUntilNone(deadline);
  }

  const std::string certificate_;                // the path of its file
  MemoryBudget request_memory_, stream_memory_;  // outlive the calls
  Reservation message_memory_;
  // Reactors post to the executors until the server is gone, so the server goes first.
  HandlerContext context_;
  std::mutex contexts_mutex_;
  std::map<std::string, std::unique_ptr<HandlerContext>> contexts_;  // guarded by contexts_mutex_
  struct Share {
    std::unique_ptr<CharacterService> service;
    std::unique_ptr<HandlerContext> context;
  };
  std::map<std::pair<HandlerContext*, std::string>, Share> shares_;  // guarded by contexts_mutex_
  std::optional<Executor> own_pose_executor_;
  Executor storage_executor_, transfer_executor_;
  std::vector<std::unique_ptr<grpc::Service>> services_;
  std::mutex shutdown_mutex_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::unique_ptr<ConnectionListener> listener_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<CallGateway> gateway_;
  std::optional<RevocationWatch> revocation_;
  std::optional<HealthWatch> health_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<GrpcServer>> GrpcServer::Start(CharacterService* service,
                                                              const GrpcServerOptions& options) {
  auto server = std::make_unique<GrpcServerImpl>(service, options);
  PLEAT_RETURN_IF_ERROR(server->Bind(options));
  return server;
}

}  // namespace pleat
