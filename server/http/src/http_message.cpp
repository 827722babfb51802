#include "pleat/http/http_message.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pleat/base/limit_refusal.h"
#include "pleat/base/utf8.h"

namespace pleat {

int HttpStatusOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return 200;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
      return 400;
    case absl::StatusCode::kUnauthenticated:
      return 401;
    case absl::StatusCode::kPermissionDenied:
      return 403;
    case absl::StatusCode::kNotFound:
      return 404;
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kFailedPrecondition:
      return 409;
    case absl::StatusCode::kResourceExhausted:
      return LimitRefusalOf(status) && !LimitRefusalOf(status)->retry_after ? 413 : 429;
    case absl::StatusCode::kUnimplemented:
      return 501;
    case absl::StatusCode::kUnavailable:
      return 503;
    case absl::StatusCode::kDeadlineExceeded:
      return 504;
    default:
      return 500;
  }
}

HttpResponse JsonResponse(std::string json) {
  return {.headers = {{"Content-Type", "application/json"}}, .body = std::move(json)};
}

HttpResponse ErrorResponse(const absl::Status& status) {
  HttpResponse response = JsonResponse(nlohmann::json{
      {"code", absl::StatusCodeToString(status.code())},
      {"message", ToValidUtf8(std::string(
                      status.message()))}}.dump());
  response.status = HttpStatusOf(status);
  const std::optional<LimitRefusal> refusal = LimitRefusalOf(status);
  if (refusal && refusal->retry_after) {
    const double seconds = std::ceil(absl::ToDoubleSeconds(*refusal->retry_after));
    response.headers.emplace_back("Retry-After",
                                  std::to_string(std::max(1, static_cast<int>(seconds))));
  }
  return response;
}

}  // namespace pleat
