// A file whose content is on the disk but which has no name in the store yet.
#pragma once

#include <string>
#include <utility>

namespace pleat {

// Made by BlobStore::Stage and Upload::Stage, consumed by BlobStore::Publish. Its content is
// complete, has the SHA-256 `id` and survives a power cut; only the rename is missing. Not
// thread-safe.
class StagedFile {
 public:
  // What happens to the file when it is never published: one that was written for this purpose
  // goes, the bytes of an upload stay where the next try finds them.
  enum class Unpublished { kRemove, kKeep };

  StagedFile(std::string id, std::string path, Unpublished unpublished)
      : id_(std::move(id)), path_(std::move(path)), unpublished_(unpublished) {}
  // For content that the store held when it was asked: there is nothing to rename.
  static StagedFile AlreadyStored(std::string id) {
    return StagedFile(std::move(id), "", Unpublished::kKeep);
  }
  ~StagedFile();
  StagedFile(StagedFile&& other) noexcept
      : id_(std::move(other.id_)),
        path_(std::exchange(other.path_, "")),
        unpublished_(other.unpublished_) {}
  StagedFile& operator=(StagedFile&&) = delete;

  const std::string& id() const { return id_; }
  const std::string& path() const { return path_; }
  bool already_stored() const { return path_.empty(); }

 private:
  friend class BlobStore;

  std::string id_;
  std::string path_;  // empty: already stored, published, or moved from
  Unpublished unpublished_;
};

}  // namespace pleat
