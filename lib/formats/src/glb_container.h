// The two chunks of a binary glTF 2.0 file and bounds-checked views of its accessors.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

inline constexpr int kMaxGltfDepth = 64;  // nested brackets of its JSON
// The first word of a file and the types of its chunks.
inline constexpr uint32_t kGlbMagic = 0x46546C67, kGlbJsonChunk = 0x4E4F534A;
inline constexpr uint32_t kGlbBinaryChunk = 0x004E4942;

// kInvalidArgument that says what is wrong with a GLB file.
absl::Status GlbFault(const std::string& what);

// The elements of one accessor, all of which lie inside the file.
class GlbAccessor {
 public:
  size_t count() const { return count_; }
  // Returns component k of element i as a number. Normalized integers become 0..1 or -1..1. Indices
  // are not checked.
  double At(size_t i, int k) const;
  // The elements one after the other, where they lie in the file as float32 in this order; else
  // null.
  const float* Floats() const;
  // All components of all elements as float32.
  std::vector<float> CopyFloats() const;

 private:
  friend class GlbContainer;
  const char* data_ = nullptr;  // null: all elements are zero but for those of the sparse list
  size_t count_ = 0, stride_ = 0;
  // The sparse list: the ascending indices of elements that are replaced, and their values.
  const char *sparse_indices_ = nullptr, *sparse_values_ = nullptr;
  size_t num_sparse_ = 0;
  int sparse_index_type_ = 0;
  size_t num_components_ = 0;
  int component_type_ = 0;  // a constant of glTF, such as 5126 for float
  bool is_normalized_ = false;
};

// A GLB file. Its bytes must outlive this object and its accessors.
class GlbContainer {
 public:
  // kInvalidArgument when the bytes are not a GLB of version 2 with a JSON chunk,
  // kResourceExhausted when that chunk, which is parsed whole, is larger than the limit.
  static absl::StatusOr<GlbContainer> Open(std::string_view bytes, const MeshLimits& limits = {});

  // Returns a member of the top level, or null when it is missing.
  const nlohmann::json& Member(const char* name) const;
  // Returns a list of the top level, which is empty when it is missing.
  const nlohmann::json& List(const char* name) const;
  // Returns an entry of such a list, or null when `index` is not an index of it.
  const nlohmann::json& Entry(const char* name, const nlohmann::json& index) const;
  // Returns the accessor `index`. kInvalidArgument when it is not of `type` ("VEC3", ...) or
  // reaches beyond the file, or when its buffer is not the file's own. It has no more elements than
  // the file has bytes, also where it is sparse and has no buffer view.
  absl::StatusOr<GlbAccessor> Access(const nlohmann::json& index, std::string_view type) const;

 private:
  // Returns where `count` elements begin in a buffer view, and their stride in bytes.
  absl::StatusOr<const char*> Elements(const nlohmann::json& view, int64_t offset, int64_t count,
                                       int64_t element_bytes, size_t* stride) const;
  absl::Status ReadSparse(const nlohmann::json& sparse, int64_t element_bytes,
                          GlbAccessor* accessor) const;

  nlohmann::json root_;
  std::string_view binary_;
};

}  // namespace pleat
