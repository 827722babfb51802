#include "cli/service.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/show/progress_display.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/local/local_character_service.h"
#include "pleat/remote/remote_character_service.h"

namespace pleat {

namespace {

constexpr uint64_t kMaxTokenFileBytes = 4096;

absl::StatusOr<std::unique_ptr<RemoteCharacterService>> Connect(const Session& session) {
  RemoteOptions options;
  options.tls = session.tls || !session.tls_ca.empty() || !session.tls_certificate.empty();
  if (!session.tls_ca.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.tls_root_certificates, ReadFile(session.tls_ca));
  }
  if (!session.tls_certificate.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.tls_client_certificate, ReadFile(session.tls_certificate));
    PLEAT_ASSIGN_OR_RETURN(options.tls_client_key, ReadFile(session.tls_key));
  }
  options.token = session.environment_token;
  if (!session.token_file.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.token, ReadFile(session.token_file, kMaxTokenFileBytes));
  }
  absl::StripAsciiWhitespace(&options.token);
  return RemoteCharacterService::Connect(session.ServerAddress(), std::move(options));
}

}  // namespace

absl::StatusOr<std::unique_ptr<CharacterService>> OpenService(const Session& session) {
  if (!session.local) return Connect(session);
  LocalServiceOptions options;
  options.data_dir = session.DataFolder();
  options.on_problem = [err = session.err](const std::string& problem) {
    *err << "warning: " << problem << "\n";
  };
  return LocalCharacterService::Open(std::move(options));
}

absl::StatusOr<std::unique_ptr<RemoteCharacterService>> OpenRemoteService(const Session& session,
                                                                          const std::string& verb) {
  if (session.local) return UsageError(verb + " talks to a server: it has no --local");
  return Connect(session);
}

absl::StatusOr<std::string> CompleteId(const std::vector<std::string>& ids,
                                       const std::string& prefix, const std::string& kind) {
  std::string found;
  for (const std::string& id : ids) {
    if (id == prefix) return id;
    if (prefix.empty() || id.compare(0, prefix.size(), prefix) != 0) continue;
    if (!found.empty()) {
      return UsageError(
          absl::StrCat("several ids of a ", kind, " begin with '", prefix, "': give more digits"));
    }
    found = id;
  }
  if (found.empty()) return absl::NotFoundError(absl::StrCat("there is no ", kind, " ", prefix));
  return found;
}

absl::StatusOr<std::string> FindModel(ModelService& models, const std::string& prefix) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<ModelInfo> infos, models.List());
  return CompleteId(infos, prefix, "model");
}

absl::StatusOr<SequenceInfo> UploadWithProgress(SequenceService& sequences,
                                                const MeshSequence& sequence,
                                                const Session& session, absl::Duration ttl) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  return sequences.Upload(sequence, InterruptibleProgress(&display).Stage("upload", 0, 1), ttl);
}

}  // namespace pleat
