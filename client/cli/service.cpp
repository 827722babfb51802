#include "cli/service.h"

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/show/progress_display.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/local/local_character_service.h"
#include "pleat/remote/remote_character_service.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<CharacterService>> OpenService(const Session& session) {
  if (session.local) {
    LocalServiceOptions options;
    options.data_dir = session.DataFolder();
    return LocalCharacterService::Open(std::move(options));
  }
  RemoteOptions options;
  options.tls = session.tls || !session.tls_ca.empty() || !session.tls_certificate.empty();
  if (!session.tls_ca.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.tls_root_certificates, ReadFile(session.tls_ca));
  }
  if (!session.tls_certificate.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.tls_client_certificate, ReadFile(session.tls_certificate));
    PLEAT_ASSIGN_OR_RETURN(options.tls_client_key, ReadFile(session.tls_key));
  }
  return RemoteCharacterService::Connect(session.ServerAddress(), std::move(options));
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

absl::StatusOr<std::string> FindModel(CharacterService& service, const std::string& prefix) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<ModelInfo> models, service.ListModels());
  return CompleteId(models, prefix, "model");
}

absl::StatusOr<SequenceInfo> UploadWithProgress(CharacterService& service,
                                                const MeshSequence& sequence,
                                                const Session& session) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  return service.UploadSequence(sequence, InterruptibleProgress(&display).Stage("upload", 0, 1));
}

}  // namespace pleat
