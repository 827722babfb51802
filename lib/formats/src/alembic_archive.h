// The tree of objects of an Alembic archive, and what all of them share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "alembic_time.h"
#include "ogawa_reader.h"

namespace pleat {

// Stands in place of an index of metadata where the text itself follows.
inline constexpr uint32_t kTextFollows = 255;

struct AlembicObject {
  std::string_view name{};      // as in the file: any bytes, not empty
  std::string_view metadata{};  // "key=value;key=value"
  int parent = -1;              // index, -1 for the top object
  OgawaRef properties{};        // the group of the properties
};

// The schemas that are read.
inline constexpr std::string_view kPolyMeshSchema = "AbcGeom_PolyMesh_v1";
inline constexpr std::string_view kSubdivisionSchema = "AbcGeom_SubD_v1";
inline constexpr std::string_view kFaceSetSchema = "AbcGeom_FaceSet_v1";
inline constexpr std::string_view kXformSchema = "AbcGeom_Xform_v3";

// The value of `key`, empty when it is not there.
std::string_view MetadataValue(std::string_view metadata, std::string_view key);

// An archive over bytes, which must outlive it. An honest archive holds each block of headers and
// each sample once, so what is read together may not be larger than the file: that bounds time and
// memory, whatever circle the references lead in.
class AlembicArchive {
 public:
  // Reads the tree of objects; their properties are read where they are needed. kInvalidArgument or
  // kDataLoss says what is wrong with the file.
  static absl::StatusOr<AlembicArchive> Open(std::string_view bytes);

  // The top object, then all others: parents before children, in the order of the file.
  const std::vector<AlembicObject>& objects() const { return objects_; }
  std::string_view schema(int object) const {
    return MetadataValue(objects_[object].metadata, "schema");
  }
  // "/actor/body", made fit for messages and UTF-8 strings.
  std::string Path(int object) const;
  // Whether `path` names the object; a slash at its end does not count.
  bool HasPath(int object, std::string_view path) const;

  std::string_view metadata() const { return metadata_; }
  // kInvalidArgument when there is no such sampling. The pointer is valid as long as the archive.
  absl::StatusOr<const AlembicTimeSampling*> TimeSampling(uint32_t number) const;
  // The text with that index. kInvalidArgument when there is none.
  absl::StatusOr<std::string_view> IndexedMetadata(uint32_t index) const;

  absl::StatusOr<OgawaGroup> Group(OgawaRef ref) const { return reader_.Group(ref); }
  // A group and the data of its last child, where its headers are; empty without such a child.
  // Each call is charged.
  struct Block {
    OgawaGroup group;
    std::string_view headers;
  };
  absl::StatusOr<Block> ReadBlock(OgawaRef ref);
  // The bytes of a sample. Charged once for each place in the file.
  absl::StatusOr<std::string_view> ReadSample(OgawaRef ref);

 private:
  explicit AlembicArchive(const OgawaReader& reader) : reader_(reader) {}

  absl::Status ReadRoot();
  absl::Status ReadIndexedMetadata(std::string_view bytes);
  absl::Status ReadObjects(OgawaRef top);
  // kDataLoss when more was read than an honest archive of this size can hold.
  absl::Status Charge(uint64_t bytes);

  OgawaReader reader_;
  std::string_view metadata_;
  std::vector<AlembicTimeSampling> samplings_;
  std::vector<std::string_view> indexed_metadata_;
  std::vector<AlembicObject> objects_;
  uint64_t charged_bytes_ = 0;
  std::unordered_set<uint64_t> charged_samples_;
};

}  // namespace pleat
