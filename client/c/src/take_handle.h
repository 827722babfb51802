// What a pleat_take is on this side of the boundary.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat_server.h"

struct pleat_take {
  pleat::MeshSequence sequence;
  std::vector<std::string> notes;
};

namespace pleat {

// The progress of a call, which ends when the caller's function says so. `report` may be null.
class CallerProgress {
 public:
  CallerProgress(pleat_progress report, void* user) : report_(report), user_(user) {}
  // Refers to this object.
  Progress token() {
    return Progress(
        [this](const ProgressUpdate& update) {
          if (report_ == nullptr || stopped_) return;
          stopped_ = report_(user_, update.stage.c_str(), update.fraction) != 0;
        },
        [this] { return stopped_.load(); });
  }

 private:
  pleat_progress report_;
  void* user_;
  std::atomic<bool> stopped_ = false;  // others ask for it
};

}  // namespace pleat
