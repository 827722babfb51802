#include "ogawa_writer.h"

#include <cstring>

namespace pleat {
namespace {

constexpr std::string_view kOgawaStart("Ogawa\xff\0\1", 8);  // closed, version 1

}  // namespace

OgawaWriter::OgawaWriter() {
  writer_.WriteRaw(kOgawaStart);
  writer_.Write(uint64_t{0});  // the position of the root, which Finish knows
}

OgawaRef OgawaWriter::AddData(std::string_view bytes, std::string_view front) {
  if (front.empty() && bytes.empty()) return {OgawaRef::kDataBit};
  const OgawaRef ref{OgawaRef::kDataBit | writer_.size()};
  writer_.Write(uint64_t{front.size() + bytes.size()});
  writer_.WriteRaw(front);
  writer_.WriteRaw(bytes);
  return ref;
}

OgawaRef OgawaWriter::AddGroup(std::span<const OgawaRef> children) {
  if (children.empty()) return {};
  const OgawaRef ref{writer_.size()};
  writer_.Write(uint64_t{children.size()});
  for (const OgawaRef child : children) writer_.Write(child.bits);
  return ref;
}

std::string OgawaWriter::Finish(OgawaRef root) {
  std::string bytes = writer_.Release();
  std::memcpy(bytes.data() + kOgawaStart.size(), &root.bits, sizeof(root.bits));
  return bytes;
}

}  // namespace pleat
