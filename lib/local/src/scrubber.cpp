#include "pleat/local/scrubber.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/stop_signal.h"
#include "pleat/base/thread_priority.h"

namespace pleat {
namespace {

struct FileToRead {
  std::string id;
  double share = 0;  // of the bytes of all files, or of their number when all are empty
};

// The files that entries name, with the share of the period that each may take.
std::vector<FileToRead> FilesOf(Store* store) {
  const absl::StatusOr<std::vector<std::string>> ids = store->catalog().FileIds();
  if (!ids.ok()) {
    store->Report(absl::StrCat("the scrubber cannot read the catalog: ",
                               std::string(ids.status().message())));
    return {};
  }
  std::vector<FileToRead> files;
  double all_bytes = 0;
  for (const std::string& id : *ids) {
    const auto bytes = static_cast<double>(store->blobs().Size(id).value_or(0)) + 1;
    files.push_back({id, bytes});
    all_bytes += bytes;
  }
  for (FileToRead& file : files) file.share /= all_bytes;
  return files;
}

}  // namespace

bool Scrubber::RunPass(Store* store, double period_seconds, const Pause& pause) {
  const std::vector<FileToRead> files = FilesOf(store);
  if (files.empty()) return pause(period_seconds);
  for (const FileToRead& file : files) {
    if (!pause(period_seconds * file.share)) return false;
    const absl::Status status = store->Verify(file.id);
    if (status.ok() || absl::IsDataLoss(status)) continue;  // Verify has reported the damage
    if (!store->catalog().NamesFile(file.id).value_or(true)) continue;  // deleted meanwhile
    store->Report(absl::StrCat("the file of '", file.id,
                               "' cannot be read: ", std::string(status.message())));
  }
  return true;
}

Scrubber::Scrubber(Store* store, double period_seconds)
    : stop_(std::make_unique<StopSignal>()), thread_([this, store, period_seconds] {
        RunInIdleTime();
        const Pause pause = [this](double seconds) { return stop_->Pause(seconds); };
        while (RunPass(store, period_seconds, pause)) {
        }
      }) {}

Scrubber::~Scrubber() {
  stop_->Set();
  thread_.join();
}

}  // namespace pleat
