// Writes the container below Alembic (docs/formats/alembic.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "ogawa_reader.h"

namespace pleat {

// Data and groups are appended as they come, so that a group follows what it refers to.
class OgawaWriter {
 public:
  OgawaWriter();

  // Makes room for that many bytes, so that the file is not copied while it grows.
  void Reserve(size_t num_bytes) { bytes_.reserve(num_bytes); }

  // `front` and `bytes` as one data; nothing at all is the empty data.
  OgawaRef AddData(std::string_view bytes, std::string_view front = {});
  OgawaRef AddGroup(std::span<const OgawaRef> children);

  // What was written so far, for comparing: the content of a data or the references of a group.
  std::string_view ContentAt(OgawaRef ref, size_t num_bytes) const {
    return std::string_view(bytes_).substr(ref.position() + sizeof(uint64_t), num_bytes);
  }

  // The whole file. The writer is empty afterwards.
  std::string Finish(OgawaRef root);

 private:
  void Write(uint64_t value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }

  std::string bytes_;
};

}  // namespace pleat
