#include "rpc_routes.h"

#include <google/protobuf/descriptor.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "file_name.h"
#include "json_calls.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

// How long a stream that says nothing keeps its thread from looking whether the client is there.
constexpr double kStreamPatienceSeconds = 1;

// The error of a stream that had begun: the status code is sent already.
std::string ErrorLine(const absl::Status& status) {
  return nlohmann::json{{"error",
                         {{"code", absl::StatusCodeToString(status.code())},
                          {"message", ToValidUtf8(std::string(status.message()))}}}}
             .dump() +
         "\n";
}

using Method = const google::protobuf::MethodDescriptor*;

// Why a call took no request; never OK.
absl::Status WhyOver(GatewayCall* call) {
  const absl::Status status = call->Finish();
  return status.ok() ? absl::InternalError("the call ended before its request") : status;
}

// Waits for the first message, so that an error before it has a status code of its own.
absl::StatusOr<std::string> FirstMessage(GatewayCall* call, bool* ended) {
  std::string message;
  GatewayCall::Got got = GatewayCall::Got::kNothingYet;
  while (got == GatewayCall::Got::kNothingYet)
    got = call->Receive(&message, kStreamPatienceSeconds);
  *ended = got == GatewayCall::Got::kEnd;
  if (*ended) PLEAT_RETURN_IF_ERROR(call->Finish());
  return message;
}

struct Stream {
  Method method;
  std::shared_ptr<GatewayCall> call;
  std::string first;
  bool has_first;

  // The next piece of the body.
  absl::StatusOr<bool> Next(std::string* piece) {
    std::string message;
    if (has_first) {
      has_first = false;
      message = std::exchange(first, {});
    } else {
      const GatewayCall::Got got = call->Receive(&message, kStreamPatienceSeconds);
      if (got == GatewayCall::Got::kNothingYet) return true;
      if (got == GatewayCall::Got::kEnd) return End(piece);
    }
    if (IsDownload(method)) {
      PLEAT_ASSIGN_OR_RETURN(FilePiece part, PieceOf(*method, message));
      *piece = std::move(part.data);
    } else {
      PLEAT_ASSIGN_OR_RETURN(*piece, ResponseToJson(*method, message));
      piece->push_back('\n');
    }
    return true;
  }
  absl::StatusOr<bool> End(std::string* piece) {
    const absl::Status status = call->Finish();
    if (!status.ok() && IsDownload(method)) return status;  // the file is cut off
    if (!status.ok()) *piece = ErrorLine(status);
    return false;
  }
  static bool IsDownload(Method method) { return pleat::IsDownload(*method); }
};

absl::StatusOr<HttpResponse> Answer(CallGateway* gateway, const RequestTarget& target,
                                    const HttpRequest& request) {
  if (target.segments.size() != 3) return absl::NotFoundError("a call is /rpc/SERVICE/METHOD");
  PLEAT_ASSIGN_OR_RETURN(Method const method, FindMethod(target.segments[1], target.segments[2]));
  if (method->client_streaming()) {
    return absl::UnimplementedError(
        absl::StrCat(method->name(), " takes a stream of messages; it is not called like this"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, RequestFromJson(*method, request.body));
  std::shared_ptr<GatewayCall> call = gateway->Start(FullName(*method), CallerOf(request));
  if (!call->Send(bytes)) return WhyOver(call.get());
  call->SendNoMore();
  bool ended = false;
  PLEAT_ASSIGN_OR_RETURN(std::string first, FirstMessage(call.get(), &ended));
  if (!method->server_streaming()) {
    PLEAT_ASSIGN_OR_RETURN(std::string json, ResponseToJson(*method, first));
    return JsonResponse(std::move(json));
  }
  HttpResponse response;
  if (IsDownload(*method)) {
    response.headers.emplace_back("Content-Type", "application/octet-stream");
    if (!ended) {
      PLEAT_ASSIGN_OR_RETURN(const FilePiece piece, PieceOf(*method, first));
      response.headers.emplace_back("X-File-Bytes", absl::StrCat(piece.size_bytes));
    }
    OfferAs(target, &response);
  } else {
    response.headers.emplace_back("Content-Type", "application/x-ndjson");
  }
  const auto stream =
      std::make_shared<Stream>(Stream{method, std::move(call), std::move(first), !ended});
  if (!ended) response.next = [stream](std::string* piece) { return stream->Next(piece); };
  return response;
}

}  // namespace

ForeignCaller CallerOf(const HttpRequest& request) {
  constexpr std::string_view kScheme = "Bearer ";
  std::string token = request.Header("authorization");
  token = absl::StartsWithIgnoreCase(token, "Bearer ") ? token.substr(kScheme.size()) : "";
  return {.token = std::move(token),
          .peer = request.peer,
          .request_id = request.Header("x-request-id")};
}

HttpResponse AnswerCall(CallGateway* gateway, const RequestTarget& target,
                        const HttpRequest& request) {
  absl::StatusOr<HttpResponse> response = Answer(gateway, target, request);
  return response.ok() ? *std::move(response) : ErrorResponse(response.status());
}

absl::StatusOr<std::string> DownloadFile(CallGateway* gateway, const ForeignCaller& caller,
                                         const std::string& service, const std::string& method_name,
                                         const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(Method const method, FindMethod(service, method_name));
  PLEAT_ASSIGN_OR_RETURN(const std::string request,
                         RequestFromJson(*method, nlohmann::json{{"id", id}}.dump()));
  const std::unique_ptr<GatewayCall> call = gateway->Start(FullName(*method), caller);
  if (!call->Send(request)) return WhyOver(call.get());
  call->SendNoMore();
  std::string bytes, message;
  while (true) {
    const GatewayCall::Got got = call->Receive(&message, kStreamPatienceSeconds);
    if (got == GatewayCall::Got::kNothingYet) continue;
    if (got == GatewayCall::Got::kEnd) break;
    PLEAT_ASSIGN_OR_RETURN(const FilePiece piece, PieceOf(*method, message));
    bytes += piece.data;
  }
  PLEAT_RETURN_IF_ERROR(call->Finish());
  return bytes;
}

}  // namespace pleat
