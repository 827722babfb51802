#include "pleat/http/studio_server.h"

#include <chrono>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <semaphore>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "model_export.h"
#include "model_routes.h"
#include "page_routes.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"
#include "pleat/http/http_server.h"
#include "pleat/service/file_limits.h"
#include "request_guard.h"
#include "request_target.h"
#include "rpc_routes.h"
#include "shared_gateway.h"
#include "take_reader.h"
#include "upload_folders.h"

namespace pleat {
namespace {

// Readings, fits and exports at the same time: each takes processor time and memory.
constexpr int kHeavyRequests = 2;
constexpr auto kHeavyWait = std::chrono::seconds(10);
constexpr double kPatienceSeconds = 1;
constexpr absl::Duration kRetryAfter = absl::Seconds(5);
constexpr uint64_t kMaxMotionBytes = uint64_t{64} << 20;
// Any id that is well-formed: the answer does not matter, only whether the caller may ask.
constexpr char kNoContent[] = "0000000000000000000000000000000000000000000000000000000000000000";

double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Studio final : public HttpHandler {
 public:
  Studio(const StudioOptions& options, GrpcServer* server)
      : options_(options),
        shared_gateway_(&server->gateway(), absl::StrJoin(options.shared, ",")),
        uploads_(options.scratch_dir,
                 {.max_files = static_cast<int>(options.limits.max_frames),
                  .max_bytes = static_cast<uint64_t>(options.limits.max_upload_bytes)},
                 MonotonicSeconds),
        models_{.gateway = gateway_,
                .admit =
                    [this, server](const ForeignCaller& caller, const char* rpc) {
                      return server->Admit(shared_gateway_.Restricted(caller), rpc);
                    },
                .uploads = &uploads_,
                .memory = options.memory,
                .limits = FileLimits(options.limits)} {}

  // Call it before the first request.
  void ServeHosts(std::vector<std::string> hosts) { hosts_ = std::move(hosts); }

  absl::StatusOr<BodyPlan> PlanBody(const HttpRequest& head) override {
    PLEAT_ASSIGN_OR_RETURN(const RequestTarget target, ParseTarget(head.target));
    PLEAT_RETURN_IF_ERROR(CheckRequest(head, KindOf(target), hosts_));
    const std::vector<std::string>& path = target.segments;
    if (head.method == "GET" || head.method == "HEAD") return BodyPlan{};
    if (path[0] == "rpc") return BodyPlan{.max_bytes = kMaxCallBytes};
    if (head.method == "PUT" && IsUpload(path) && path.size() == 3) {
      const auto name = target.query.find("path");
      if (name == target.query.end()) return absl::InvalidArgumentError("a file has a ?path=");
      PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<BodySink> sink,
                             uploads_.AddFile(CallerOf(head).token, path[2], name->second));
      return BodyPlan{.max_bytes = static_cast<uint64_t>(options_.limits.max_upload_bytes),
                      .sink = std::move(sink)};
    }
    return BodyPlan{.max_bytes = kMaxMotionBytes};
  }

  HttpResponse Handle(const HttpRequest& request) override {
    absl::StatusOr<HttpResponse> response = absl::InternalError("nobody has answered");
    try {
      response = Route(request);
    } catch (const std::bad_alloc&) {
      response = RefuseForLimit({.limit = "--memory-bytes", .retry_after = kRetryAfter},
                                "the server has no memory left for this request");
    } catch (const std::exception& error) {
      response = absl::InternalError(error.what());
    }
    HttpResponse answer = response.ok() ? *std::move(response) : ErrorResponse(response.status());
    AddSafetyHeaders(&answer);
    return answer;
  }

  absl::StatusOr<std::unique_ptr<WebSocketSession>> OpenWebSocket(
      const HttpRequest& head) override {
    PLEAT_ASSIGN_OR_RETURN(const RequestTarget target, ParseTarget(head.target));
    PLEAT_RETURN_IF_ERROR(CheckRequest(head, RequestKind::kSocket, hosts_));
    if (target.segments != std::vector<std::string>{"live"}) {
      return absl::NotFoundError("live sessions are at /live");
    }
    return MakeLiveSocket(gateway_, CallerOf(head));
  }

 private:
  static bool IsUpload(const std::vector<std::string>& path) {
    return path.size() >= 2 && path[0] == "studio" && path[1] == "uploads";
  }
  static RequestKind KindOf(const RequestTarget& target) {
    const std::string& first = target.segments.front();
    return first == "rpc" || first == "studio" ? RequestKind::kCall : RequestKind::kPage;
  }

  absl::StatusOr<HttpResponse> Route(const HttpRequest& request) {
    PLEAT_ASSIGN_OR_RETURN(const RequestTarget target, ParseTarget(request.target));
    const std::vector<std::string>& path = target.segments;
    if (KindOf(target) == RequestKind::kPage) {
      if (request.method != "GET" && request.method != "HEAD") {
        return absl::UnimplementedError("files of the page can only be read");
      }
      return AnswerPage(absl::StrCat("/", absl::StrJoin(path, "/")), request);
    }
    if (path[0] == "rpc") {
      if (request.method != "POST") return absl::UnimplementedError("calls are made by POST");
      return AnswerCall(gateway_, target, request);
    }
    if (IsUpload(path)) return Upload(target, request);
    if (path.size() == 2 && path[1] == "about") return About();
    if (path.size() == 2 && path[1] == "example" && request.method == "POST") {
      PLEAT_RETURN_IF_ERROR(CheckMayUpload(CallerOf(request)));
      return Heavy([&]() -> HttpResponse {
        const absl::StatusOr<std::string> json = StoreExample(gateway_, CallerOf(request));
        return json.ok() ? JsonResponse(*json) : ErrorResponse(json.status());
      });
    }
    if (path.size() > 1 && path[1] == "models") {
      return Heavy([&] { return models_.Answer(target, request); });
    }
    return absl::NotFoundError("there is nothing at this address");
  }

  // POST uploads -> {"id"}; PUT uploads/ID?path=P; POST uploads/ID?name=N reads the take; DELETE.
  absl::StatusOr<HttpResponse> Upload(const RequestTarget& target, const HttpRequest& request) {
    const ForeignCaller caller = CallerOf(request);
    if (request.method == "POST" && target.segments.size() == 2) {
      PLEAT_RETURN_IF_ERROR(CheckMayUpload(caller));
      PLEAT_ASSIGN_OR_RETURN(const std::string id, uploads_.Begin(caller.token));
      return JsonResponse(nlohmann::json{{"id", id}}.dump());
    }
    if (target.segments.size() != 3) return absl::NotFoundError("there is no such upload");
    const std::string& id = target.segments[2];
    if (request.method == "PUT") return JsonResponse("{}");  // the sink has taken it
    if (request.method == "DELETE") {
      uploads_.Remove(caller.token, id);
      return JsonResponse("{}");
    }
    return Heavy([&]() -> HttpResponse {
      absl::StatusOr<UploadFolders::Folder> folder = uploads_.Find(caller.token, id);
      if (!folder.ok()) return ErrorResponse(folder.status());
      const auto name = target.query.find("name");
      const absl::StatusOr<std::string> json =
          StoreTake(gateway_, caller, *folder, name == target.query.end() ? "" : name->second,
                    FileLimits(options_.limits), options_.memory);
      uploads_.Remove(caller.token, id);
      return json.ok() ? JsonResponse(*json) : ErrorResponse(json.status());
    });
  }

  // A call that needs the same permission as an upload and changes nothing.
  absl::Status CheckMayUpload(const ForeignCaller& caller) {
    const std::unique_ptr<GatewayCall> call =
        gateway_->Start("/pleat.v1.SequenceService/QueryUpload", caller);
    // QueryUploadRequest{id}: field 1, length 64.
    call->Send(absl::StrCat("\x0a\x40", kNoContent));
    call->SendNoMore();
    std::string answer;
    while (call->Receive(&answer, kPatienceSeconds) != GatewayCall::Got::kEnd) {
    }
    return call->Finish();
  }

  HttpResponse About() const {
    return JsonResponse(nlohmann::json{{"version", options_.version},
                                       {"formats", ExportFormats()},
                                       {"shared", options_.shared},
                                       {"maxUploadBytes", options_.limits.max_upload_bytes},
                                       {"maxVertices", options_.limits.max_vertices},
                                       {"maxFrames", options_.limits.max_frames}}
                            .dump());
  }

  template <typename Work>
  absl::StatusOr<HttpResponse> Heavy(Work work) {
    if (!heavy_.try_acquire_for(kHeavyWait)) {
      return RefuseForLimit({.limit = "studio", .retry_after = kRetryAfter},
                            "the server is busy with other takes; try again in some seconds");
    }
    struct Release {
      std::counting_semaphore<>* semaphore;
      ~Release() { semaphore->release(); }
    } const release{&heavy_};
    return work();
  }

  const StudioOptions options_;
  SharedGateway shared_gateway_;
  CallGateway* const gateway_ = &shared_gateway_;
  UploadFolders uploads_;
  const ModelRoutes models_;
  std::vector<std::string> hosts_;
  std::counting_semaphore<> heavy_{kHeavyRequests};
};

class StudioServerImpl final : public StudioServer {
 public:
  StudioServerImpl(const StudioOptions& options, GrpcServer* server) : studio_(options, server) {}
  absl::Status Serve(const StudioOptions& options) {
    PLEAT_ASSIGN_OR_RETURN(
        http_, HttpServer::Start(
                   {.listen = options.listen,
                    .on_bound =
                        [&](const std::string& address) {
                          studio_.ServeHosts(HostsOf(address, options.hosts));
                        },
                    .max_body_bytes = static_cast<uint64_t>(options.limits.max_upload_bytes)},
                   &studio_));
    return absl::OkStatus();
  }
  std::string address() const override { return http_->address(); }
  void Shutdown() override { http_->Shutdown(); }

 private:
  Studio studio_;
  std::unique_ptr<HttpServer> http_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<StudioServer>> StudioServer::Start(StudioOptions options,
                                                                  GrpcServer* server) {
  auto studio = std::make_unique<StudioServerImpl>(options, server);
  PLEAT_RETURN_IF_ERROR(studio->Serve(options));
  return studio;
}

}  // namespace pleat
