// The verbs of `pleat`. Each has one function and one file (verb_<name>.cpp). The function adds the
// verb to the parser; the verb runs later, through Session::run.
#pragma once

#include <functional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/time/time.h"
#include "cli/session.h"

namespace pleat {

// Adds a verb with the flags that all verbs share (--quiet, --json). When the parser chooses it,
// session.run becomes `run`.
CLI::App* AddVerb(CLI::App& app, Session& session, const std::string& name,
                  const std::string& description, std::function<absl::Status()> run);

// With --strict, kFailedPrecondition when a result has warnings. What was asked for is written
// nevertheless.
absl::Status RefuseWarningsWhenStrict(const Session& session, size_t num_warnings);

// Adds --server, --local, --data-dir and the flags of TLS, for verbs that can run on a server.
void AddServerFlags(CLI::App* verb, Session& session);
// Does the same for verbs that run in this process unless --server or --data-dir is given.
// RunsOnService says which of the two it is.
void AddOptionalServerFlags(CLI::App* verb, Session& session);
bool RunsOnService(const Session& session);
// Adds --ttl-hours: how long a service keeps `what`. TtlOf gives its value; 0 hours are for ever.
void AddTtlFlag(CLI::App* verb, const std::string& what, double* ttl_hours);
absl::Duration TtlOf(double ttl_hours);
// Adds --object, --animation and --key, for verbs that read sequences.
void AddObjectFlag(CLI::App* verb, Session& session);
// Adds --force, for verbs that write files.
void AddForceFlag(CLI::App* verb, Session& session);
// Adds --local alone, for verbs that always run in this process.
void AddInProcessFlag(CLI::App* verb, Session& session);

void AddGenerateVerb(CLI::App& app, Session& session);
void AddConvertVerb(CLI::App& app, Session& session);
void AddCompressVerb(CLI::App& app, Session& session);
void AddDecompressVerb(CLI::App& app, Session& session);
void AddInspectVerb(CLI::App& app, Session& session);
void AddCompareVerb(CLI::App& app, Session& session);
void AddRenderVerb(CLI::App& app, Session& session);
void AddRigVerb(CLI::App& app, Session& session);
void AddTrainVerb(CLI::App& app, Session& session);
void AddPoseVerb(CLI::App& app, Session& session);
void AddExportVerb(CLI::App& app, Session& session);
void AddMotionVerb(CLI::App& app, Session& session);
void AddBenchVerb(CLI::App& app, Session& session);
void AddEvaluateVerb(CLI::App& app, Session& session);
void AddStudioVerb(CLI::App& app, Session& session);
void AddBatchVerb(CLI::App& app, Session& session);
void AddUploadVerb(CLI::App& app, Session& session);
void AddSequencesVerb(CLI::App& app, Session& session);
void AddJobsVerb(CLI::App& app, Session& session);
void AddModelsVerb(CLI::App& app, Session& session);
void AddCompressedVerb(CLI::App& app, Session& session);
void AddStoreVerb(CLI::App& app, Session& session);
void AddTokenVerb(CLI::App& app, Session& session);
void AddStatusVerb(CLI::App& app, Session& session);
void AddCompletionVerb(CLI::App& app, Session& session);
void AddManualVerb(CLI::App& app, Session& session);
void AddVersionVerb(CLI::App& app, Session& session);

}  // namespace pleat
