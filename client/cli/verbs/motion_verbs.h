// The verbs below `pleat motion`.
#pragma once

#include <functional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "cli/session.h"

namespace pleat {

// Does the same as AddVerb for a verb below `motion`. Errors name it "motion NAME".
CLI::App* AddVerbOfMotion(CLI::App& motion, Session& session, const std::string& name,
                          const std::string& description, std::function<absl::Status()> run);

void AddMotionMapVerb(CLI::App& motion, Session& session);
void AddMotionEditVerb(CLI::App& motion, Session& session);
void AddMotionUndoVerb(CLI::App& motion, Session& session);

}  // namespace pleat
