// Ogawa, the container below Alembic: groups of references to groups and data, over bytes that may
// be hostile (docs/formats/alembic.md).
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

#include "absl/status/statusor.h"

namespace pleat {

// Where a group or data lies.
struct OgawaRef {
  static constexpr uint64_t kDataBit = uint64_t{1} << 63;

  uint64_t bits = 0;  // 0 is the empty group, kDataBit alone the empty data

  bool is_data() const { return (bits & kDataBit) != 0; }
  uint64_t position() const { return bits & ~kDataBit; }
  friend bool operator==(const OgawaRef&, const OgawaRef&) = default;
};

// The references of a group, as they lie in the file.
class OgawaGroup {
 public:
  OgawaGroup() = default;
  explicit OgawaGroup(std::string_view references) : references_(references) {}

  size_t size() const { return references_.size() / sizeof(uint64_t); }
  OgawaRef child(size_t i) const {  // i below size()
    OgawaRef ref;
    std::memcpy(&ref.bits, references_.data() + i * sizeof(uint64_t), sizeof(uint64_t));
    return ref;
  }

 private:
  std::string_view references_;
};

// Follows references. Every one is checked against the bytes that are there; nothing is copied or
// allocated, so the bytes must outlive all groups and data. Nothing keeps references from leading
// in a circle: whoever follows them bounds how far.
class OgawaReader {
 public:
  // kInvalidArgument when the bytes are no Ogawa file, or one that its writer did not close;
  // kDataLoss when the header is cut off.
  static absl::StatusOr<OgawaReader> Open(std::string_view bytes);

  OgawaRef root() const { return root_; }
  size_t num_bytes() const { return bytes_.size(); }

  // kDataLoss when the reference leads to the other kind or out of the file.
  absl::StatusOr<OgawaGroup> Group(OgawaRef ref) const;
  absl::StatusOr<std::string_view> Data(OgawaRef ref) const;

 private:
  OgawaReader(std::string_view bytes, OgawaRef root) : bytes_(bytes), root_(root) {}

  // The bytes behind the 64-bit number at ref.position(), which counts items of `item_bytes`.
  absl::StatusOr<std::string_view> Counted(OgawaRef ref, uint64_t item_bytes) const;

  std::string_view bytes_;
  OgawaRef root_;
};

}  // namespace pleat
