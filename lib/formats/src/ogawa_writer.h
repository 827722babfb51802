// Writes the container below Alembic (docs/formats/alembic.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "ogawa_reader.h"
#include "pleat/base/bytes.h"

namespace pleat {

// Data and groups are appended as they come, so that a group follows what it refers to.
class OgawaWriter {
 public:
  OgawaWriter();

  // `front` and `bytes` as one data; nothing at all is the empty data.
  OgawaRef AddData(std::string_view bytes, std::string_view front = {});
  OgawaRef AddGroup(std::span<const OgawaRef> children);

  // What was written so far, for comparing: the content of a data or the references of a group.
  std::string_view ContentAt(OgawaRef ref, size_t num_bytes) const {
    return std::string_view(writer_.bytes()).substr(ref.position() + sizeof(uint64_t), num_bytes);
  }

  // The whole file. The writer is empty afterwards.
  std::string Finish(OgawaRef root);

 private:
  ByteWriter writer_;
};

}  // namespace pleat
