// What a batch does with one take: it is uploaded, trained or compressed by a service, and the
// result is downloaded.
#pragma once

#include <string>
#include <variant>

#include "cli/batch/batch_list.h"
#include "cli/batch/batch_report.h"
#include "cli/session.h"
#include "pleat/service/character_service.h"

namespace pleat {

struct BatchJob {
  JobOptions options{};      // training or compression
  std::string fps{};         // of inputs that do not say; as --fps
  std::string output_dir{};  // NAME.pleat or NAME.plt; empty: results stay on the service
  absl::Duration ttl = kKeepForEver;
};

// The content of the inputs as far as names, sizes and times of change tell, and the options.
std::string FingerprintOf(const BatchTake& take, const BatchJob& job);

// Fills the row. The same attempt of the same take finds the job that it has made before. Ctrl-C
// ends it without waiting; the job goes on. Thread-safe if the service is.
void WorkOnTake(CharacterService* service, const Session& session, const BatchJob& job,
                const BatchTake& take, int attempt, BatchRow* row);

}  // namespace pleat
