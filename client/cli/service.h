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

// Connects to the server of --server, of PLEAT_SERVER, or at the default address. With --local it
// opens the service of this process over the data folder.
absl::StatusOr<std::unique_ptr<CharacterService>> OpenService(const Session& session);

// Connects to the same server, for verbs that need live sessions, which only the remote service
// has. With --local it returns a usage error that names `verb`.
absl::StatusOr<std::unique_ptr<RemoteCharacterService>> OpenRemoteService(const Session& session,
                                                                          const std::string& verb);

// Returns the one id among `ids` that begins with `prefix`, since people copy the first digits
// only. kNotFound names `kind`. It is a usage error when several ids begin like this.
absl::StatusOr<std::string> CompleteId(const std::vector<std::string>& ids,
                                       const std::string& prefix, const std::string& kind);

// Does the same for things that have an id.
template <typename Info>
absl::StatusOr<std::string> CompleteId(const std::vector<Info>& infos, const std::string& prefix,
                                       const std::string& kind) {
  std::vector<std::string> ids;
  for (const Info& info : infos) ids.push_back(info.id);
  return CompleteId(ids, prefix, kind);
}

// Returns the id of the only model whose id begins with `prefix`.
absl::StatusOr<std::string> FindModel(ModelService& models, const std::string& prefix);

// Uploads a sequence, shows the progress and stops on Ctrl-C. ttl: how long it is kept at least.
absl::StatusOr<SequenceInfo> UploadWithProgress(SequenceService& sequences,
                                                const MeshSequence& sequence,
                                                const Session& session,
                                                absl::Duration ttl = kKeepForEver);

// Watches a job until its state is final and shows its progress. On Ctrl-C it cancels the job if
// `cancel_on_interrupt` says so. A job that failed gives its own error. stage_seconds receives the
// seconds of every stage; it may be null.
absl::StatusOr<JobInfo> WatchJobToEnd(JobService& jobs, const std::string& id,
                                      const Session& session, bool cancel_on_interrupt,
                                      std::map<std::string, double>* stage_seconds);

}  // namespace pleat
