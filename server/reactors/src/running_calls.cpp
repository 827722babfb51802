#include "pleat/reactors/running_calls.h"

#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/random_id.h"
#include "pleat/base/sha256.h"
#include "pleat/identity/token.h"
#include "pleat/reactors/admission.h"

namespace pleat {
namespace {

constexpr int kSecretWords = 8;  // 256 bits

// "ipv4:10.0.0.7:52114" without the port, which is another one for each connection.
std::string HostOfPeer(const std::string& peer) {
  return peer.starts_with("ipv4:") || peer.starts_with("ipv6:") ? peer.substr(0, peer.rfind(':'))
                                                                : peer;
}

std::string_view MetadataOf(const grpc::ServerContextBase& call, const char* key) {
  const auto found = call.client_metadata().find(key);
  if (found == call.client_metadata().end()) return {};
  return {found->second.data(), found->second.size()};
}

// What a call of this process says with a key of its metadata; empty where it says nothing, or
// comes from elsewhere.
std::string SaidInside(const grpc::ServerContextBase& call, const char* key) {
  if (MetadataOf(call, kInsideKey) != InsideSecret()) return "";
  return std::string(MetadataOf(call, key));
}

}  // namespace

const std::string& InsideSecret() {
  static const std::string& secret = *new std::string(RandomHexId(kSecretWords));
  return secret;
}

std::string PeerOf(const grpc::ServerContextBase& call) {
  const std::string said = SaidInside(call, kForeignPeerKey);
  return said.empty() ? call.peer() : said;
}

std::string SharedContentOf(const grpc::ServerContextBase& call) {
  return SaidInside(call, kSharedContentKey);
}

CallOrigin OriginOf(const grpc::ServerContextBase& call) {
  const std::string shown = ShownToken(call);
  const std::optional<TokenText> token = ParseTokenText(shown);
  if (!token) return {.client = HostOfPeer(PeerOf(call)), .token_id = {}};
  return {.client = absl::StrCat("token:", ToHex(ComputeSha256(shown))), .token_id = token->id};
}

RunningCalls::Entry::Entry(RunningCalls* calls, const CallOrigin& origin, std::string request_id,
                           bool is_stream, const grpc::ServerContextBase* context)
    : calls_(calls), stream_client_(is_stream ? origin.client : ""), context_(context) {
  auto call = std::make_shared<Call>();
  call->context = context;
  call->request_id = std::move(request_id);
  std::lock_guard lock(calls_->mutex_);
  calls_->by_context_.emplace(context, call);
  place_ = calls_->calls_.emplace(origin.token_id, std::move(call));
  if (is_stream) ++calls_->streams_[stream_client_];
}

RunningCalls::Entry::~Entry() {
  std::shared_ptr<Call> call;
  {
    std::lock_guard lock(calls_->mutex_);
    call = place_->second;
    calls_->calls_.erase(place_);
    calls_->by_context_.erase(context_);
    const auto streams = calls_->streams_.find(stream_client_);
    if (streams != calls_->streams_.end() && --streams->second == 0) {
      calls_->streams_.erase(streams);
    }
  }
  std::lock_guard lock(call->mutex);
  call->context = nullptr;
}

std::string RunningCalls::RequestIdOf(const grpc::ServerContextBase& context) {
  std::lock_guard lock(mutex_);
  const auto call = by_context_.find(&context);
  return call == by_context_.end() ? std::string() : call->second->request_id;
}

void RunningCalls::NoteProject(const grpc::ServerContextBase& context, const std::string& project) {
  std::lock_guard lock(mutex_);
  const auto call = by_context_.find(&context);
  if (call != by_context_.end()) call->second->project = project;
}

std::string RunningCalls::ProjectOf(const grpc::ServerContextBase& context) {
  std::lock_guard lock(mutex_);
  const auto call = by_context_.find(&context);
  return call == by_context_.end() ? std::string() : call->second->project;
}

int RunningCalls::NumStreams(const std::string& client) {
  std::lock_guard lock(mutex_);
  const auto streams = streams_.find(client);
  return streams == streams_.end() ? 0 : streams->second;
}

void RunningCalls::CancelUnless(const std::function<bool(const std::string& token_id)>& is_good) {
  Calls calls;
  {
    std::lock_guard lock(mutex_);
    calls = calls_;
  }
  calls.erase("");  // these showed no token
  for (auto it = calls.begin(); it != calls.end();) {
    const auto end = calls.upper_bound(it->first);
    const bool good = is_good(it->first);
    for (; it != end; ++it) {
      if (good) continue;
      std::lock_guard lock(it->second->mutex);
      if (it->second->context != nullptr) it->second->context->TryCancel();
    }
  }
}

}  // namespace pleat
