#include "pleat/reactors/admission.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr absl::Duration kRetryAfter = absl::Seconds(2);

constexpr RpcRule kRules[] = {
    {"QueryUpload", Scope::kTrain, false},
    {"UploadSequence", Scope::kTrain, true},
    {"GetSequence", Scope::kRead, false},
    {"DownloadSequence", Scope::kRead, true},
    {"ListSequences", Scope::kRead, false},
    {"DeleteSequence", Scope::kAdmin, true},
    {"PinSequence", Scope::kAdmin, true},
    {"DeleteUpload", Scope::kTrain, true},
    {"CreateTrainingJob", Scope::kTrain, true},
    {"CreateCompressionJob", Scope::kTrain, true},
    {"GetJob", Scope::kRead, false},
    {"ListJobs", Scope::kRead, false},
    {"WatchJob", Scope::kRead, false},
    {"CancelJob", Scope::kTrain, true},
    {"DeleteJob", Scope::kAdmin, true},
    {"GetModel", Scope::kRead, false},
    {"ListModels", Scope::kRead, false},
    {"DeleteModel", Scope::kAdmin, true},
    {"PinModel", Scope::kAdmin, true},
    {"DownloadModel", Scope::kRead, true},
    {"UploadCompressedSequence", Scope::kTrain, true},
    {"GetCompressedSequence", Scope::kRead, false},
    {"ListCompressedSequences", Scope::kRead, false},
    {"DeleteCompressedSequence", Scope::kAdmin, true},
    {"PinCompressedSequence", Scope::kAdmin, true},
    {"DownloadCompressedSequence", Scope::kRead, true},
    {"DecodeFrames", Scope::kPose, true},
    {"GetStreamHeader", Scope::kPose, false},
    {"EvaluatePose", Scope::kPose, false},
    {"EvaluateClip", Scope::kPose, true},
    {"LiveSession", Scope::kPose, true},
};

// The context of the token's project.
absl::StatusOr<HandlerContext*> AdmitToProject(HandlerContext* context,
                                               const std::string& token_text, const char* rpc) {
  ServerCalls& calls = *context->calls;
  if (calls.tokens == nullptr || !calls.tokens->required()) return context;
  const RpcRule* rule = FindRpcRule(rpc);
  if (rule == nullptr) return absl::InternalError(absl::StrCat("nobody says who may call ", rpc));
  PLEAT_ASSIGN_OR_RETURN(const Token token, calls.tokens->Authenticate(token_text));
  if (!token.scopes.Has(rule->scope)) {
    return absl::PermissionDeniedError(absl::StrCat("the token '", token.name, "' allows ",
                                                    ScopesText(token.scopes), "; ", rpc, " needs ",
                                                    ScopeName(rule->scope)));
  }
  return calls.of_project ? calls.of_project(token.project) : context;
}

}  // namespace

const RpcRule* FindRpcRule(std::string_view rpc) {
  for (const RpcRule& rule : kRules) {
    if (rule.rpc == rpc) return &rule;
  }
  return nullptr;
}

std::string ShownToken(const grpc::ServerContextBase& call) {
  const auto it = call.client_metadata().find("authorization");
  if (it == call.client_metadata().end()) return "";
  absl::string_view value(it->second.data(), it->second.size());
  constexpr absl::string_view kScheme = "Bearer ";
  if (!absl::StartsWithIgnoreCase(value, kScheme)) return "";
  value.remove_prefix(kScheme.size());
  return std::string(value);
}

absl::StatusOr<HandlerContext*> AdmitToken(HandlerContext* context, const std::string& token_text,
                                           const std::string& shared, const char* rpc) {
  const ServerCalls& calls = *context->calls;
  const bool may_show_token = calls.tokens != nullptr && calls.tokens->required();
  if (shared.empty() || (may_show_token && !token_text.empty())) {
    return AdmitToProject(context, token_text, rpc);
  }
  if (!calls.of_share) return absl::InternalError("this server shares nothing");
  return calls.of_share(context, shared);
}

absl::StatusOr<HandlerContext*> Admit(HandlerContext* context, const grpc::ServerContextBase& call,
                                      const char* rpc) {
  PLEAT_ASSIGN_OR_RETURN(HandlerContext* const admitted,
                         AdmitToken(context, ShownToken(call), SharedContentOf(call), rpc));
  context->calls->running_calls.NoteProject(call, admitted->project);
  return admitted;
}

absl::StatusOr<HandlerContext*> AdmitStream(HandlerContext* context,
                                            const grpc::ServerContextBase& call, const char* rpc) {
  PLEAT_ASSIGN_OR_RETURN(HandlerContext * admitted, Admit(context, call, rpc));
  const int limit = context->calls->max_streams_per_client;
  // This stream is among those that are counted.
  if (limit == 0 || context->calls->running_calls.NumStreams(OriginOf(call).client) <= limit) {
    return admitted;
  }
  return RefuseForLimit(
      {.subject = kClientLimit, .limit = "--max-streams-per-client", .retry_after = kRetryAfter},
      absl::StrCat("this client has ", limit,
                   " streams (--max-streams-per-client); close one of them or try again later"));
}

}  // namespace pleat
