// A view of a service that shows some content and changes nothing, for a link that is sent to
// others.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/character_service.h"

namespace pleat {

// The services behind the view, which must outlive it.
struct SharedFrom {
  SequenceService* sequences = nullptr;
  JobService* jobs = nullptr;
  ModelService* models = nullptr;
  PoseService* poses = nullptr;
};

// Only the sequences and models with these ids, and the jobs that made such a model, are there:
// everything else is kNotFound, as if it did not exist. Whatever would change something is
// kPermissionDenied. Compressed sequences are not in the view.
std::unique_ptr<CharacterService> MakeSharedService(const SharedFrom& from,
                                                    std::set<std::string> ids);

// The ids of a model and of the sequences that it was trained on, as far as they are still there.
// kNotFound for a model that the service does not have.
absl::StatusOr<std::set<std::string>> ContentOfModel(CharacterService* service,
                                                     const std::string& model_id);

}  // namespace pleat
