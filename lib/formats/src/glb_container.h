// The two chunks of a binary glTF 2.0 file and bounds-checked views of its accessors.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "absl/status/statusor.h"

namespace pleat {

// The elements of one accessor, all of which lie inside the file.
class GlbAccessor {
 public:
  size_t count() const { return count_; }
  // Returns component k of element i as a number. Normalized integers become 0..1 or -1..1. Indices
  // are not checked.
  double At(size_t i, int k) const;

 private:
  friend class GlbContainer;
  const char* data_ = nullptr;
  size_t count_ = 0, stride_ = 0;
  int component_type_ = 0;  // a constant of glTF, such as 5126 for float
  bool is_normalized_ = false;
};

// A GLB file. Its bytes must outlive this object and its accessors.
class GlbContainer {
 public:
  // kInvalidArgument when the bytes are not a GLB of version 2 with a JSON chunk.
  static absl::StatusOr<GlbContainer> Open(std::string_view bytes);

  // Returns a list of the top level, which is empty when it is missing.
  const nlohmann::json& List(const char* name) const;
  // Returns an entry of such a list, or null when `index` is not an index of it.
  const nlohmann::json& Entry(const char* name, const nlohmann::json& index) const;
  // Returns the accessor `index`. kInvalidArgument when it is not of `type` ("VEC3", ...), reaches
  // beyond the file or is sparse, or when its buffer is not the file's own.
  absl::StatusOr<GlbAccessor> Access(const nlohmann::json& index, std::string_view type) const;

 private:
  nlohmann::json root_;
  std::string_view binary_;
};

}  // namespace pleat
