#include "upload_folders.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/random_id.h"
#include "pleat/base/status.h"
#include "request_target.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr int kIdWords = 2;
constexpr absl::Duration kUploadRetryAfter = absl::Seconds(30);

}  // namespace

class UploadFolders::File final : public BodySink {
 public:
  File(UploadFolders* folders, std::string id, std::ofstream file)
      : folders_(folders), id_(std::move(id)), file_(std::move(file)) {}
  absl::Status Append(std::string_view bytes) override {
    PLEAT_RETURN_IF_ERROR(folders_->Charge(id_, bytes.size()));
    file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file_.flush();
    if (file_) return absl::OkStatus();
    return RefuseForLimit({.limit = "disk", .retry_after = kUploadRetryAfter},
                          "the server cannot write what arrives: its disk is full or fails");
  }

 private:
  UploadFolders* const folders_;
  const std::string id_;
  std::ofstream file_;
};

UploadFolders::UploadFolders(std::string root, UploadFolderLimits limits,
                             std::function<double()> clock)
    : root_(std::move(root)), limits_(limits), clock_(std::move(clock)) {
  std::error_code ignored;
  fs::remove_all(root_, ignored);
}

UploadFolders::~UploadFolders() {
  std::error_code ignored;
  fs::remove_all(root_, ignored);
}

absl::StatusOr<std::string> UploadFolders::Begin(const std::string& owner) {
  std::lock_guard lock(mutex_);
  RemoveIdleLocked();
  if (entries_.size() >= static_cast<size_t>(limits_.max_folders)) {
    return RefuseForLimit({.limit = "uploads", .retry_after = kUploadRetryAfter},
                          "too many uploads are under way; try again later");
  }
  const std::string id = RandomHexId(kIdWords);
  const std::string path = root_ + "/" + id;
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    return absl::UnavailableError(absl::StrCat("cannot make ", path, ": ", error.message()));
  entries_[id] = {.owner = owner, .folder = {.path = path}, .touched = clock_()};
  return id;
}

absl::StatusOr<std::shared_ptr<BodySink>> UploadFolders::AddFile(const std::string& owner,
                                                                 const std::string& id,
                                                                 const std::string& relative_path) {
  PLEAT_ASSIGN_OR_RETURN(const std::string inside, CheckRelativePath(relative_path));
  std::string path;
  {
    std::lock_guard lock(mutex_);
    PLEAT_ASSIGN_OR_RETURN(Entry* const entry, FindLocked(owner, id));
    if (entry->folder.num_files >= limits_.max_files) {
      return RefuseForLimit({.limit = "--max-frames"},
                            absl::StrCat("a take may have ", limits_.max_files, " files"));
    }
    ++entry->folder.num_files;
    path = entry->folder.path + "/" + inside;
  }
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  std::ofstream file;
  if (!error && !fs::exists(path)) file.open(path, std::ios::binary);
  if (!file.is_open()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", inside, "' cannot be made; two files of the take have this name"));
  }
  return std::make_shared<File>(this, id, std::move(file));
}

absl::StatusOr<UploadFolders::Folder> UploadFolders::Find(const std::string& owner,
                                                          const std::string& id) {
  std::lock_guard lock(mutex_);
  PLEAT_ASSIGN_OR_RETURN(const Entry* const entry, FindLocked(owner, id));
  return entry->folder;
}

void UploadFolders::Remove(const std::string& owner, const std::string& id) {
  std::lock_guard lock(mutex_);
  const absl::StatusOr<Entry*> entry = FindLocked(owner, id);
  if (!entry.ok()) return;
  std::error_code ignored;
  fs::remove_all((*entry)->folder.path, ignored);
  bytes_ -= (*entry)->folder.bytes;
  entries_.erase(id);
}

absl::StatusOr<UploadFolders::Entry*> UploadFolders::FindLocked(const std::string& owner,
                                                                const std::string& id) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.owner != owner) {
    return absl::NotFoundError("this upload is not known any more; drop the files again");
  }
  found->second.touched = clock_();
  return &found->second;
}

void UploadFolders::RemoveIdleLocked() {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (clock_() - entry->second.touched < limits_.idle_seconds) {
      ++entry;
      continue;
    }
    std::error_code ignored;
    fs::remove_all(entry->second.folder.path, ignored);
    bytes_ -= entry->second.folder.bytes;
    entry = entries_.erase(entry);
  }
}

absl::Status UploadFolders::Charge(const std::string& id, uint64_t bytes) {
  std::lock_guard lock(mutex_);
  const auto entry = entries_.find(id);
  if (entry == entries_.end()) return absl::AbortedError("the upload was given up");
  if (bytes > limits_.max_bytes - bytes_) {
    return RefuseForLimit({.limit = "--max-upload-bytes"},
                          absl::StrCat("the files of all uploads may have ", limits_.max_bytes,
                                       " bytes (--max-upload-bytes)"));
  }
  bytes_ += bytes;
  entry->second.folder.bytes += bytes;
  entry->second.touched = clock_();
  return absl::OkStatus();
}

absl::StatusOr<std::string> ChooseInput(const std::string& folder) {
  static const std::set<std::string>& sequences =
      *new std::set<std::string>{".abc", ".mdd", ".npy", ".npz", ".pc2", ".pseq", ".glb", ".gltf"};
  std::vector<fs::path> files, sequence_files;
  std::set<fs::path> folders;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    files.push_back(entry.path());
    folders.insert(entry.path().parent_path());
    if (sequences.contains(absl::AsciiStrToLower(entry.path().extension().string()))) {
      sequence_files.push_back(entry.path());
    }
  }
  if (files.empty()) return absl::InvalidArgumentError("no file has arrived; drop the take again");
  if (sequence_files.size() == 1) return sequence_files.front().string();
  if (files.size() == 1) return files.front().string();
  if (folders.size() == 1) return folders.begin()->string();
  return absl::InvalidArgumentError(
      "the files lie in several folders and none of them is a cache; drop the folder with the "
      "frames alone");
}

}  // namespace pleat
