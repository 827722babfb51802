#include "pleat/store/quarantine.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <system_error>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "file_sync.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr char kManifest[] = "manifest.tsv";  // lines of name, time, reason, between tabs
constexpr char kTimeFormat[] = "%Y-%m-%dT%H:%M:%SZ";
constexpr uint64_t kMaxManifestBytes = uint64_t{1} << 30;

}  // namespace

absl::Status Quarantine::WriteDown(const std::string& name, const std::string& reason) {
  const std::string path = absl::StrCat(folder_, "/", kManifest);
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (fd < 0) return ErrnoStatus(errno, "cannot open the manifest of the quarantine");
  const std::string line = absl::StrCat(
      EscapeControls(name), "\t", absl::FormatTime(kTimeFormat, absl::Now(), absl::UTCTimeZone()),
      "\t", EscapeControls(reason), "\n");
  absl::Status status;
  // One call for the whole line: a crash leaves all of it or a line that has no end.
  if (write(fd, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    status = ErrnoStatus(errno, "cannot write the manifest of the quarantine");
  }
  if (status.ok()) status = SyncFile(fd, path, before_sync_);
  close(fd);
  return status;
}

absl::Status Quarantine::Take(const std::string& path, const std::string& reason) {
  std::lock_guard lock(mutex_);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return ErrnoStatus(error.value(), "cannot create the quarantine");
  const fs::path source(path);
  std::string name = source.filename();
  for (int number = 2; fs::exists(fs::path(folder_) / name, error); ++number) {
    name = absl::StrCat(source.filename().string(), ".", number);
  }
  PLEAT_RETURN_IF_ERROR(WriteDown(name, reason));
  if (rename(path.c_str(), absl::StrCat(folder_, "/", name).c_str()) != 0) {
    return ErrnoStatus(
        errno, absl::StrCat("cannot move '", source.filename().string(), "' to the quarantine"));
  }
  PLEAT_RETURN_IF_ERROR(SyncFolder(folder_, before_sync_));
  return SyncFolder(source.parent_path(), before_sync_);
}

absl::StatusOr<std::vector<QuarantinedFile>> Quarantine::List() const {
  std::error_code error;
  if (!fs::exists(folder_, error)) return std::vector<QuarantinedFile>();
  std::map<std::string, std::pair<std::string, std::string>> lines;  // the last of a name counts
  const absl::StatusOr<std::string> text =
      ReadFile(absl::StrCat(folder_, "/", kManifest), kMaxManifestBytes);
  if (text.ok()) {
    for (const absl::string_view line : absl::StrSplit(*text, '\n', absl::SkipEmpty())) {
      const std::vector<std::string> fields = absl::StrSplit(line, '\t');
      if (fields.size() == 3) lines[fields[0]] = {fields[1], fields[2]};
    }
  }
  std::vector<QuarantinedFile> files;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (!it->is_regular_file(ignored) || it->path().filename() == kManifest) continue;
    QuarantinedFile file{.name = it->path().filename(), .size_bytes = it->file_size(ignored)};
    if (const auto line = lines.find(EscapeControls(file.name)); line != lines.end()) {
      std::tie(file.time, file.reason) = line->second;
    }
    files.push_back(std::move(file));
  }
  if (error) return ErrnoStatus(error.value(), "cannot list the quarantine");
  std::ranges::sort(files, {}, &QuarantinedFile::name);
  return files;
}

}  // namespace pleat
