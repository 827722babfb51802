// Which service a verb talks to: a server, or the store on this machine.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/session.h"
#include "pleat/service/character_service.h"

namespace pleat {

class RemoteCharacterService;

// The server of --server (or PLEAT_SERVER, or the default address), or with --local the service in
// this process over the data folder.
absl::StatusOr<std::unique_ptr<CharacterService>> OpenService(const Session& session);

// The same server, for verbs that need more than the services: live sessions are a matter of the
// network. A usage error that names `verb` with --local.
absl::StatusOr<std::unique_ptr<RemoteCharacterService>> OpenRemoteService(const Session& session,
                                                                          const std::string& verb);

// The one id among `ids` that begins with `prefix`: people copy the first digits. kNotFound names
// `kind`; a usage error when several begin so.
absl::StatusOr<std::string> CompleteId(const std::vector<std::string>& ids,
                                       const std::string& prefix, const std::string& kind);

// The same among things that have an id.
template <typename Info>
absl::StatusOr<std::string> CompleteId(const std::vector<Info>& infos, const std::string& prefix,
                                       const std::string& kind) {
  std::vector<std::string> ids;
  for (const Info& info : infos) ids.push_back(info.id);
  return CompleteId(ids, prefix, kind);
}

// The id of the only model whose id begins with `prefix`.
absl::StatusOr<std::string> FindModel(ModelService& models, const std::string& prefix);

// Uploads with progress; Ctrl-C stops it.
absl::StatusOr<SequenceInfo> UploadWithProgress(SequenceService& sequences,
                                                const MeshSequence& sequence,
                                                const Session& session);

// Watches a job with progress until it is final. On Ctrl-C the job is cancelled when
// `cancel_on_interrupt`. A job that failed gives its own error.
absl::StatusOr<JobInfo> WatchJobToEnd(JobService& jobs, const std::string& id,
                                      const Session& session, bool cancel_on_interrupt,
                                      std::map<std::string, double>* stage_seconds);

}  // namespace pleat
