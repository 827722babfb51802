// The two chunks of a binary glTF 2.0 file and bounds-checked views of its accessors.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "absl/status/statusor.h"

namespace pleat {

// Elements of one accessor; all of them lie inside the file.
class GlbAccessor {
 public:
  size_t count() const { return count_; }
  // Component k of element i as a number; normalized integers become 0..1 or -1..1.
  double At(size_t i, int k) const;

 private:
  friend class GlbContainer;
  const char* data_ = nullptr;
  size_t count_ = 0, stride_ = 0;
  int component_type_ = 0;  // glTF constant
  bool is_normalized_ = false;
};

// The bytes must outlive this object.
class GlbContainer {
 public:
  // kInvalidArgument when the bytes are no GLB of version 2 with a JSON chunk.
  static absl::StatusOr<GlbContainer> Open(std::string_view bytes);

  // A top-level list, empty when it is missing.
  const nlohmann::json& List(const char* name) const;
  // An entry of such a list; null when `index` is not one.
  const nlohmann::json& Entry(const char* name, const nlohmann::json& index) const;
  // kInvalidArgument when the accessor is not of `type` ("VEC3", ...) or leaves the file;
  // kUnimplemented for sparse accessors and other buffers than the file's own.
  absl::StatusOr<GlbAccessor> Access(const nlohmann::json& index, std::string_view type) const;

 private:
  nlohmann::json root_;
  std::string_view binary_;
};

}  // namespace pleat
