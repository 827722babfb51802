#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "npy_array.h"
#include "npz_arrays.h"
#include "pleat/formats/npz.h"
#include "zip_archive.h"

namespace pleat {
namespace {

int64_t Length(size_t count) { return static_cast<int64_t>(count); }

// A member of the archive under the user's name for its role, else under that of Pleat.
void AddMember(const std::string& key, const char* name, const std::string& array, ZipWriter* zip) {
  zip->Add((key.empty() ? std::string(name) : key) + ".npy", array);
}

// Of all frames, without putting them together first.
void AddPositions(const MeshSequence& sequence, const NpzKeys& keys, ZipWriter* zip) {
  const std::string header = NpyHeader("<f4", {sequence.num_frames(), sequence.num_vertices(), 3});
  std::vector<std::string_view> parts = {header};
  size_t num_bytes = 0;
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    parts.emplace_back(reinterpret_cast<const char*>(frame.data()),
                       static_cast<size_t>(frame.size()) * sizeof(float));
    num_bytes += parts.back().size();
  }
  constexpr size_t kRoomForHeaders = 65536;
  zip->Reserve(num_bytes + kRoomForHeaders +
               sequence.topology().corner_vertices().size() * 2 * sizeof(int32_t));
  zip->Add((keys.positions.empty() ? std::string("positions") : keys.positions) + ".npy", parts);
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

}  // namespace

std::string EncodeNpy(const MeshSequence& sequence) {
  std::string bytes = NpyHeader("<f4", {sequence.num_frames(), sequence.num_vertices(), 3});
  bytes.reserve(bytes.size() + MeshCounts{.num_vertices = sequence.num_vertices(),
                                          .num_frames = sequence.num_frames()}
                                   .position_bytes());
  for (int t = 0; t < sequence.num_frames(); ++t) {
    const Eigen::Matrix3Xf& frame = sequence.frame(t);
    bytes.append(reinterpret_cast<const char*>(frame.data()),
                 static_cast<size_t>(frame.size()) * sizeof(float));
  }
  return bytes;
}

std::string EncodeNpz(const MeshSequence& sequence, const NpzWriteOptions& options) {
  ZipWriter zip({.deflates = options.compressed});
  const NpzKeys& keys = options.keys;
  AddPositions(sequence, keys, &zip);
  AddFaces(sequence.topology(), keys, &zip);
  const FrameRate rate = sequence.frame_rate();
  const int32_t fraction[] = {rate.numerator, rate.denominator};
  AddMember(keys.frame_rate, "frame_rate", EncodeNpyIntegers(fraction, {2}), &zip);
  const auto first_frame = static_cast<float>(options.first_frame);
  zip.Add("first_frame.npy", EncodeNpyFloats(std::span(&first_frame, 1), {}));
  if (!sequence.name().empty()) zip.Add("name.npy", EncodeNpyTexts({sequence.name()}));
  AddAppearance(sequence.appearance(), &zip);
  return zip.Finish();
}

}  // namespace pleat
