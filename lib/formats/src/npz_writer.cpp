#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "npy_array.h"
#include "npz_arrays.h"
#include "pleat/base/file_parts.h"
#include "pleat/formats/npz.h"
#include "zip_archive.h"

namespace pleat {
namespace {

int64_t Length(size_t count) { return static_cast<int64_t>(count); }

// A member of the archive under the user's name for its role, else under that of Pleat.
void AddMember(const std::string& key, const char* name, const std::string& array, ZipWriter* zip) {
  zip->Add((key.empty() ? std::string(name) : key) + ".npy", array);
}

// A header, which `kept` keeps, and a view of each frame.
std::vector<std::string_view> PositionParts(const MeshSequence& sequence, std::string* kept) {
  *kept = NpyHeader("<f4", {sequence.num_frames(), sequence.num_vertices(), 3});
  std::vector<std::string_view> parts = {*kept};
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    parts.emplace_back(reinterpret_cast<const char*>(frame.data()),
                       static_cast<size_t>(frame.size()) * sizeof(float));
  }
  return parts;
}

void AddFaces(const Topology& topology, const NpzKeys& keys, ZipWriter* zip) {
  const std::vector<int32_t>& corners = topology.corner_vertices();
  std::vector<int32_t> sizes;
  for (int f = 0; f < topology.num_faces(); ++f)
    sizes.push_back(static_cast<int32_t>(topology.face(f).size()));
  const bool is_table = std::ranges::all_of(sizes, [&](int32_t size) { return size == sizes[0]; });
  if (is_table) {
    const int64_t width = sizes.empty() ? 3 : sizes[0];
    AddMember(keys.faces, "faces", EncodeNpyIntegers(corners, {Length(sizes.size()), width}), zip);
    return;
  }
  AddMember(keys.faces, "faces", EncodeNpyIntegers(corners, {Length(corners.size())}), zip);
  AddMember(keys.face_sizes, "face_sizes", EncodeNpyIntegers(sizes, {Length(sizes.size())}), zip);
}

void AddAppearance(const MeshAppearance& appearance, ZipWriter* zip) {
  if (!appearance.texcoords.empty()) {
    const std::span<const float> values(appearance.texcoords[0].data(),
                                        2 * appearance.texcoords.size());
    zip->Add("texcoords.npy", EncodeNpyFloats(values, {Length(appearance.texcoords.size()), 2}));
  }
  const std::pair<const char*, const std::vector<int32_t>*> lists[] = {
      {"corner_texcoords.npy", &appearance.corner_texcoords},
      {"face_materials.npy", &appearance.face_materials}};
  for (const auto& [name, list] : lists) {
    if (!list->empty()) zip->Add(name, EncodeNpyIntegers(*list, {Length(list->size())}));
  }
  if (!appearance.material_names.empty()) {
    zip->Add("material_names.npy", EncodeNpyTexts(appearance.material_names));
  }
  if (!appearance.material_library.empty()) {
    zip->Add("material_library.npy", EncodeNpyTexts({appearance.material_library}));
  }
}

// header: keeps bytes that the archive refers to.
void AddMembers(const MeshSequence& sequence, const NpzKeys& keys, double first_frame,
                std::string* header, ZipWriter* zip) {
  zip->Add((keys.positions.empty() ? std::string("positions") : keys.positions) + ".npy",
           PositionParts(sequence, header));
  AddFaces(sequence.topology(), keys, zip);
  const FrameRate rate = sequence.frame_rate();
  const int32_t fraction[] = {rate.numerator, rate.denominator};
  AddMember(keys.frame_rate, "frame_rate", EncodeNpyIntegers(fraction, {2}), zip);
  const auto first = static_cast<float>(first_frame);
  zip->Add("first_frame.npy", EncodeNpyFloats(std::span(&first, 1), {}));
  if (!sequence.name().empty()) zip->Add("name.npy", EncodeNpyTexts({sequence.name()}));
  AddAppearance(sequence.appearance(), zip);
}

}  // namespace

std::string EncodeNpy(const MeshSequence& sequence) {
  std::string header, bytes;
  const std::vector<std::string_view> parts = PositionParts(sequence, &header);
  bytes.reserve(header.size() + (parts.size() - 1) * parts[1].size());
  for (const std::string_view part : parts) bytes.append(part);
  return bytes;
}

absl::Status WriteNpy(const std::string& path, const MeshSequence& sequence) {
  std::string header;
  return WriteFileParts(path, PositionParts(sequence, &header));
}

std::string EncodeNpz(const MeshSequence& sequence, const NpzWriteOptions& options) {
  ZipWriter zip({.deflates = options.compressed});
  std::string header;
  AddMembers(sequence, options.keys, options.first_frame, &header, &zip);
  return zip.Finish();
}

absl::Status WriteNpz(const std::string& path, const MeshSequence& sequence,
                      const NpzWriteOptions& options) {
  ZipWriter zip({.deflates = options.compressed});
  std::string header;
  AddMembers(sequence, options.keys, options.first_frame, &header, &zip);
  return WriteFileParts(path, zip.FinishParts());
}

}  // namespace pleat
