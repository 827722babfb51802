#include "ogawa_writer.h"

#include <cstring>
#include <utility>

namespace pleat {
namespace {

constexpr std::string_view kOgawaStart("Ogawa\xff\0\1", 8);  // closed, version 1

}  // namespace

OgawaWriter::OgawaWriter() {
  bytes_.append(kOgawaStart);
  Write(0);  // the position of the root, which Finish knows
}

OgawaRef OgawaWriter::AddData(std::string_view bytes, std::string_view front) {
  if (front.empty() && bytes.empty()) return {OgawaRef::kDataBit};
  const OgawaRef ref{OgawaRef::kDataBit | bytes_.size()};
  Write(front.size() + bytes.size());
  bytes_.append(front);
  bytes_.append(bytes);
  return ref;
}

OgawaRef OgawaWriter::AddGroup(std::span<const OgawaRef> children) {
  if (children.empty()) return {};
  const OgawaRef ref{bytes_.size()};
  Write(children.size());
  for (const OgawaRef child : children) Write(child.bits);
  return ref;
}

std::string OgawaWriter::Finish(OgawaRef root) {
  std::string bytes = std::move(bytes_);
  std::memcpy(bytes.data() + kOgawaStart.size(), &root.bits, sizeof(root.bits));
  return bytes;
}

}  // namespace pleat
