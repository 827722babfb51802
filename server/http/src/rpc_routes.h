// Calls of pleat.v1 for a browser: POST /rpc/SERVICE/METHOD with the request as JSON.
#pragma once

#include <memory>
#include <string>

#include "pleat/grpc/call_gateway.h"
#include "pleat/http/http_message.h"
#include "request_target.h"

namespace pleat {

inline constexpr uint64_t kMaxCallBytes = uint64_t{16} << 20;

// On whose behalf a request is made: the token of its header "authorization", and its peer.
ForeignCaller CallerOf(const HttpRequest& request);

// Answers with the response as JSON; of a stream with a line of JSON for each message and a last
// one {"error": {...}} when it ends with an error; of a download with the bytes of the file, which
// is offered under the name of the query "save" when there is one.
HttpResponse AnswerCall(CallGateway* gateway, const RequestTarget& target,
                        const HttpRequest& request);

// The whole response of a call that gives a file; for the server's own use.
absl::StatusOr<std::string> DownloadFile(CallGateway* gateway, const ForeignCaller& caller,
                                         const std::string& service, const std::string& method,
                                         const std::string& id);

// A frames of a character, live: the messages of LiveSession, each as one binary message. The first
// message of the client is the text {"token": "..."}; the last one of the server is the text
// {"code": "...", "message": "..."}, when the session has ended.
std::unique_ptr<WebSocketSession> MakeLiveSocket(CallGateway* gateway, ForeignCaller caller);

}  // namespace pleat
