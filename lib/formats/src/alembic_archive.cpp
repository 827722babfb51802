#include "alembic_archive.h"

#include <algorithm>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

constexpr int kMaxTreeDepth = 1000;
constexpr size_t kHashBytes = 32;  // behind the headers of the children
// The children of the root group.
constexpr size_t kLayoutVersion = 0, kLibraryVersion = 1, kTop = 2, kMetadata = 3;
constexpr size_t kTimeSamplings = 4, kIndexedMetadata = 5, kNumRootChildren = 6;
constexpr int32_t kOldestLibrary = 9999;

absl::StatusOr<int32_t> ReadVersion(std::string_view bytes, absl::string_view what) {
  ByteReader reader(bytes);
  return reader.Read<int32_t>(what);
}

// One header of a child. Its place in the tree is set by the caller.
absl::StatusOr<AlembicObject> ReadObjectHeader(const AlembicArchive& archive, ByteReader* reader) {
  AlembicObject object;
  PLEAT_ASSIGN_OR_RETURN(const uint32_t name_bytes, reader->Read<uint32_t>("an object's name"));
  if (name_bytes == 0 || name_bytes > kMaxNameBytes) {
    return absl::InvalidArgumentError(absl::StrCat("an object has a name of ", name_bytes,
                                                   " bytes; 1 to ", kMaxNameBytes, " are allowed"));
  }
  PLEAT_ASSIGN_OR_RETURN(object.name, reader->ReadRaw(name_bytes, "an object's name"));
  PLEAT_ASSIGN_OR_RETURN(const uint8_t index, reader->Read<uint8_t>("an object's metadata"));
  if (index != kTextFollows) {
    PLEAT_ASSIGN_OR_RETURN(object.metadata, archive.IndexedMetadata(index));
    return object;
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t bytes, reader->Read<uint32_t>("an object's metadata"));
  PLEAT_ASSIGN_OR_RETURN(object.metadata, reader->ReadRaw(bytes, "an object's metadata"));
  return object;
}

// An object whose children are still to be read.
struct OpenObject {
  AlembicObject object;
  OgawaRef group;
  int depth = 0;
};

// The children of the object with index `parent`, in order. Fills in where its properties are.
absl::StatusOr<std::vector<OpenObject>> ReadChildren(const OpenObject& open, int parent,
                                                     AlembicArchive* archive,
                                                     OgawaRef* properties) {
  PLEAT_ASSIGN_OR_RETURN(const AlembicArchive::Block block, archive->ReadBlock(open.group));
  *properties = {};
  if (block.group.size() > 0 && !block.group.child(0).is_data()) {
    *properties = block.group.child(0);
  }
  std::vector<OpenObject> children;
  if (block.headers.size() <= kHashBytes) return children;
  ByteReader reader(block.headers.substr(0, block.headers.size() - kHashBytes));
  while (reader.remaining() > 0) {
    OpenObject child;
    PLEAT_ASSIGN_OR_RETURN(child.object, ReadObjectHeader(*archive, &reader));
    const size_t place = children.size() + 1;  // behind the properties
    if (place + 1 >= block.group.size()) {
      return absl::DataLossError(absl::StrCat("the object '", EscapeControls(child.object.name),
                                              "' has a header but no content"));
    }
    child.object.parent = parent;
    child.group = block.group.child(place);
    child.depth = open.depth + 1;
    children.push_back(std::move(child));
  }
  return children;
}

}  // namespace

std::string_view MetadataValue(std::string_view metadata, std::string_view key) {
  for (const absl::string_view pair :
       absl::StrSplit(absl::string_view(metadata.data(), metadata.size()), ';')) {
    const size_t equals = pair.find('=');
    if (equals == absl::string_view::npos) continue;
    if (std::string_view(pair.data(), equals) != key) continue;
    return {pair.data() + equals + 1, pair.size() - equals - 1};
  }
  return {};
}

absl::StatusOr<AlembicArchive> AlembicArchive::Open(std::string_view bytes) {
  PLEAT_ASSIGN_OR_RETURN(const OgawaReader reader, OgawaReader::Open(bytes));
  AlembicArchive archive(reader);
  PLEAT_RETURN_IF_ERROR(archive.ReadRoot());
  return archive;
}

absl::Status AlembicArchive::ReadRoot() {
  PLEAT_ASSIGN_OR_RETURN(const OgawaGroup root, reader_.Group(reader_.root()));
  if (root.size() < kNumRootChildren) {
    return absl::InvalidArgumentError(absl::StrCat("the root has ", root.size(),
                                                   " children, not the ", kNumRootChildren,
                                                   " of an Alembic archive"));
  }
  std::string_view parts[kNumRootChildren];
  for (size_t i = 0; i < kNumRootChildren; ++i) {
    if (i == kTop) continue;
    PLEAT_ASSIGN_OR_RETURN(parts[i], reader_.Data(root.child(i)));
    PLEAT_RETURN_IF_ERROR(Charge(parts[i].size()));
  }
  PLEAT_ASSIGN_OR_RETURN(const int32_t layout,
                         ReadVersion(parts[kLayoutVersion], "the version of the layout"));
  PLEAT_ASSIGN_OR_RETURN(const int32_t library,
                         ReadVersion(parts[kLibraryVersion], "the version of the library"));
  if (layout != 0 || library < kOldestLibrary) {
    return absl::InvalidArgumentError(absl::StrCat("layout ", layout, " of library version ",
                                                   library, " is not known; known is layout 0 of ",
                                                   kOldestLibrary, " and newer"));
  }
  metadata_ = parts[kMetadata];
  PLEAT_ASSIGN_OR_RETURN(samplings_, ParseTimeSamplings(parts[kTimeSamplings]));
  PLEAT_RETURN_IF_ERROR(ReadIndexedMetadata(parts[kIndexedMetadata]));
  return ReadObjects(root.child(kTop));
}

absl::Status AlembicArchive::ReadIndexedMetadata(std::string_view bytes) {
  ByteReader reader(bytes);
  indexed_metadata_.push_back({});
  while (reader.remaining() > 0) {
    PLEAT_ASSIGN_OR_RETURN(const uint8_t size, reader.Read<uint8_t>("indexed metadata"));
    PLEAT_ASSIGN_OR_RETURN(const std::string_view text, reader.ReadRaw(size, "indexed metadata"));
    indexed_metadata_.push_back(text);
  }
  return absl::OkStatus();
}

// Depth first, with a stack of its own: hostile archives are deep.
absl::Status AlembicArchive::ReadObjects(OgawaRef top) {
  std::vector<OpenObject> open = {{{.name = "ABC"}, top, 0}};
  while (!open.empty()) {
    const OpenObject next = std::move(open.back());
    open.pop_back();
    if (next.depth > kMaxTreeDepth) {
      return absl::InvalidArgumentError(
          absl::StrCat("objects are nested more than ", kMaxTreeDepth, " deep"));
    }
    const int index = static_cast<int>(objects_.size());
    objects_.push_back(next.object);
    PLEAT_ASSIGN_OR_RETURN(std::vector<OpenObject> children,
                           ReadChildren(next, index, this, &objects_[index].properties));
    open.insert(open.end(), std::make_move_iterator(children.rbegin()),
                std::make_move_iterator(children.rend()));
  }
  return absl::OkStatus();
}

absl::Status AlembicArchive::Charge(uint64_t bytes) {
  charged_bytes_ += bytes;
  if (charged_bytes_ <= reader_.num_bytes()) return absl::OkStatus();
  return absl::DataLossError(
      "parts of the archive lead back to others that were read before; the file is damaged");
}

absl::StatusOr<AlembicArchive::Block> AlembicArchive::ReadBlock(OgawaRef ref) {
  Block block;
  PLEAT_ASSIGN_OR_RETURN(block.group, reader_.Group(ref));
  const size_t size = block.group.size();
  if (size > 0 && block.group.child(size - 1).is_data()) {
    PLEAT_ASSIGN_OR_RETURN(block.headers, reader_.Data(block.group.child(size - 1)));
  }
  // The empty group lies nowhere, and nothing is below it.
  if (size > 0) PLEAT_RETURN_IF_ERROR(Charge(8 + 8 * size + block.headers.size()));
  return block;
}

absl::StatusOr<std::string_view> AlembicArchive::ReadSample(OgawaRef ref) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, reader_.Data(ref));
  if (charged_samples_.insert(ref.position()).second) PLEAT_RETURN_IF_ERROR(Charge(bytes.size()));
  return bytes;
}

absl::StatusOr<const AlembicTimeSampling*> AlembicArchive::TimeSampling(uint32_t number) const {
  if (number < samplings_.size()) return &samplings_[number];
  return absl::InvalidArgumentError(absl::StrCat("time sampling ", number, " is named, but the ",
                                                 "archive has ", samplings_.size()));
}

absl::StatusOr<std::string_view> AlembicArchive::IndexedMetadata(uint32_t index) const {
  if (index < indexed_metadata_.size()) return indexed_metadata_[index];
  return absl::InvalidArgumentError(absl::StrCat("metadata ", index, " is named, but the archive ",
                                                 "has ", indexed_metadata_.size()));
}

std::string AlembicArchive::Path(int object) const {
  std::vector<std::string> names;
  for (; objects_[object].parent >= 0; object = objects_[object].parent) {
    names.push_back(EscapeControls(NameToUtf8(objects_[object].name)));
  }
  std::string path;
  for (auto name = names.rbegin(); name != names.rend(); ++name) absl::StrAppend(&path, "/", *name);
  return path.empty() ? "/" : path;
}

bool AlembicArchive::HasPath(int object, std::string_view path) const {
  if (path.ends_with('/')) path.remove_suffix(1);
  for (; objects_[object].parent >= 0; object = objects_[object].parent) {
    const std::string_view name = objects_[object].name;
    if (!path.ends_with(name)) return false;
    path.remove_suffix(name.size());
    if (!path.ends_with('/')) return false;
    path.remove_suffix(1);
  }
  return path.empty();
}

}  // namespace pleat
