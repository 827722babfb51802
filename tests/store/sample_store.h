// A data folder with a few entries, and the damage that tests do to it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/store/records.h"
#include "pleat/store/store.h"
#include "support/temporary_folder.h"

namespace pleat {

inline std::string IdOf(const std::string& bytes) { return ToHex(ComputeSha256(bytes)); }

// Three sequences, "zero", "one" and "two", whose files hold just these words, and a job.
class SampleStore {
 public:
  static std::string RecordOf(const std::string& bytes) {
    SequenceInfo info;
    info.id = IdOf(bytes);
    info.name = bytes;
    info.num_frames = 1;
    info.num_vertices = 3;
    info.num_faces = 1;
    info.size_bytes = bytes.size();
    return EncodeRecord(info);
  }

  SampleStore() {
    const auto store = Open();
    for (const char* bytes : {"zero", "one", "two"}) Add(store.get(), bytes);
    JobInfo job;
    job.id = "job-1";
    store->catalog().Put(EntryKind::kJob, {job.id, EncodeRecord(job)}).IgnoreError();
  }
  std::unique_ptr<Store> Open() const {
    return Store::Open({.data_dir = data_dir(), .reserve_bytes = 0}).value();
  }
  static void Add(Store* store, const std::string& bytes) {
    store->Add(EntryKind::kSequence, {IdOf(bytes), RecordOf(bytes)}, bytes).IgnoreError();
  }

  std::string data_dir() const { return folder_.File("data"); }
  std::string File(const std::string& name) const { return folder_.File(name); }
  std::string PathOf(const std::string& bytes) const {
    const std::string id = IdOf(bytes);
    return data_dir() + "/blobs/" + id.substr(0, 2) + "/" + id;
  }
  void Damage(const std::string& bytes) const {
    WriteFile(PathOf(bytes), std::string(bytes.size(), '?')).IgnoreError();
  }
  void Remove(const std::string& bytes) const { std::filesystem::remove(PathOf(bytes)); }
  // A row that no program can read.
  void BreakRow(const std::string& bytes) const {
    const auto catalog = Catalog::Open(data_dir() + "/catalogue.db").value();
    catalog->Put(EntryKind::kSequence, {IdOf(bytes), "\xff\xff\xff"}).IgnoreError();
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace pleat
