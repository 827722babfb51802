// Source: Khronos, glTF 2.0 specification, sections 3.6 (buffers, accessors) and 4.4 (binary
// files). All offsets and counts of the file are hostile: an accessor is refused unless its last
// element ends inside the buffer view, and the view inside the chunk, in arithmetic that cannot
// overflow.
#include "glb_container.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "json_depth.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsignedInt = 5125, kFloat = 5126;

uint32_t ReadU32(std::string_view bytes, size_t at) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);  // the file is little-endian, as this machine is
  return value;
}

template <typename T>
double Load(const char* data) {
  T value;
  std::memcpy(&value, data, sizeof(T));
  return static_cast<double>(value);
}

size_t ComponentBytes(int type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

size_t NumComponents(std::string_view type) {
  if (type == "MAT4") return 16;
  return type == "VEC4" ? 4 : type == "VEC3" ? 3 : type == "VEC2" ? 2 : 1;
}

// Returns number i of a list of unsigned integers.
size_t LoadIndex(const char* list, int type, size_t i) {
  const char* data = list + i * ComponentBytes(type);
  return static_cast<size_t>(type == kUnsignedByte    ? Load<uint8_t>(data)
                             : type == kUnsignedShort ? Load<uint16_t>(data)
                                                      : Load<uint32_t>(data));
}

// Returns a non-negative whole number of a JSON object, `fallback` when it is missing, and -1 when
// it is anything else or above 2^40.
int64_t Size(const json& object, const char* name, int64_t fallback) {
  const auto found = object.find(name);
  if (found == object.end()) return fallback;
  if (!found->is_number_integer() || *found < 0 || *found > int64_t{1} << 40) return -1;
  return found->get<int64_t>();
}

// Extensions without which the positions of a mesh cannot be read. Others may be required as well
// (materials, textures): they concern neither meshes nor rigs.
absl::Status CheckExtensions(const json& root) {
  static constexpr std::string_view kCompressions[] = {
      "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression"};
  const auto required = root.find("extensionsRequired");
  if (required == root.end() || !required->is_array()) return absl::OkStatus();
  for (const json& extension : *required) {
    for (const std::string_view name : kCompressions) {
      if (extension == std::string(name)) {
        return GlbFault(absl::StrCat("the file needs ", std::string(name),
                                     ", which is not read: export it without compression"));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

double GlbAccessor::At(size_t i, int k) const {
  const char* element = data_ ? data_ + i * stride_ : nullptr;
  size_t begin = 0, end = num_sparse_;
  while (begin < end) {
    const size_t middle = begin + (end - begin) / 2;
    const size_t index = LoadIndex(sparse_indices_, sparse_index_type_, middle);
    if (index == i) {
      element = sparse_values_ + middle * num_components_ * ComponentBytes(component_type_);
      break;
    }
    (index < i ? begin : end) = index < i ? middle + 1 : middle;
  }
  if (!element) return 0;
  const char* data = element + k * ComponentBytes(component_type_);
  switch (component_type_) {
    case kByte:
      return is_normalized_ ? std::max(-1.0, Load<int8_t>(data) / 127) : Load<int8_t>(data);
    case kUnsignedByte:
      return is_normalized_ ? Load<uint8_t>(data) / 255 : Load<uint8_t>(data);
    case kShort:
      return is_normalized_ ? std::max(-1.0, Load<int16_t>(data) / 32767) : Load<int16_t>(data);
    case kUnsignedShort:
      return is_normalized_ ? Load<uint16_t>(data) / 65535 : Load<uint16_t>(data);
    case kUnsignedInt:
      return Load<uint32_t>(data);
    default:
      return Load<float>(data);
  }
}

const float* GlbAccessor::Floats() const {
  const bool is_plain = data_ != nullptr && num_sparse_ == 0 && component_type_ == kFloat &&
                        stride_ == num_components_ * sizeof(float) &&
                        reinterpret_cast<uintptr_t>(data_) % alignof(float) == 0;
  return is_plain ? reinterpret_cast<const float*>(data_) : nullptr;
}

std::vector<float> GlbAccessor::CopyFloats() const {
  if (const float* floats = Floats()) return {floats, floats + count_ * num_components_};
  std::vector<float> values;
  values.reserve(count_ * num_components_);
  for (size_t i = 0; i < count_; ++i) {
    for (size_t k = 0; k < num_components_; ++k) {
      values.push_back(static_cast<float>(At(i, static_cast<int>(k))));
    }
  }
  return values;
}

absl::Status GlbFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: ", what));
}

absl::StatusOr<GlbContainer> GlbContainer::Open(std::string_view bytes, const MeshLimits& limits) {
  if (bytes.size() < 20 || ReadU32(bytes, 0) != kGlbMagic)
    return GlbFault("not a binary glTF file");
  if (ReadU32(bytes, 4) != 2) {
    return GlbFault(absl::StrCat("version ", ReadU32(bytes, 4), ", not 2"));
  }
  if (ReadU32(bytes, 8) > bytes.size()) {
    return GlbFault(absl::StrCat("cut off: ", bytes.size(), " of ", ReadU32(bytes, 8), " bytes"));
  }
  GlbContainer glb;
  bool has_json = false;
  for (size_t at = 12; at + 8 <= bytes.size();) {
    const uint64_t size = ReadU32(bytes, at);
    const uint32_t kind = ReadU32(bytes, at + 4);
    if (size > bytes.size() - at - 8) return GlbFault("a chunk reaches beyond the end");
    const std::string_view chunk = bytes.substr(at + 8, size);
    if (kind == kGlbJsonChunk && !has_json) {
      if (size > limits.max_document_bytes) {
        return absl::ResourceExhaustedError(absl::StrCat(
            "GLB: ", size, " bytes of JSON; the limit is ", limits.max_document_bytes));
      }
      if (NestsTooDeep(chunk, kMaxGltfDepth)) {
        return GlbFault(absl::StrCat("JSON nested deeper than ", kMaxGltfDepth, " levels"));
      }
      glb.root_ = json::parse(chunk, nullptr, false);
      has_json = true;
    } else if (kind == kGlbBinaryChunk && glb.binary_.empty()) {
      glb.binary_ = chunk;
    }
    at += 8 + size;
  }
  if (!has_json || !glb.root_.is_object()) return GlbFault("the JSON chunk is missing or damaged");
  PLEAT_RETURN_IF_ERROR(CheckExtensions(glb.root_));
  return glb;
}

const json& GlbContainer::Member(const char* name) const {
  static const json& null = *new json();
  const auto found = root_.find(name);
  return found != root_.end() ? *found : null;
}

const json& GlbContainer::List(const char* name) const {
  static const json& empty = *new json(json::array());
  const json& member = Member(name);
  return member.is_array() ? member : empty;
}

const json& GlbContainer::Entry(const char* name, const json& index) const {
  static const json& null = *new json();
  const json& list = List(name);
  if (!index.is_number_integer() || index < 0 || index >= list.size()) return null;
  return list[index.get<size_t>()];
}

absl::StatusOr<GlbAccessor> GlbContainer::Access(const json& index, std::string_view type) const {
  const json& accessor = Entry("accessors", index);
  if (!accessor.is_object() || accessor.value("type", json()) != std::string(type)) {
    return GlbFault(absl::StrCat("an accessor of type ", std::string(type), " is missing"));
  }
  GlbAccessor result;
  const int64_t component = Size(accessor, "componentType", 0);
  result.component_type_ = static_cast<int>(std::clamp<int64_t>(component, 0, kFloat));
  result.is_normalized_ = accessor.value("normalized", json()) == true;
  result.num_components_ = NumComponents(type);
  const auto element_bytes =
      static_cast<int64_t>(result.num_components_ * ComponentBytes(result.component_type_));
  const int64_t count = Size(accessor, "count", -1);
  if (element_bytes == 0 || count < 1 || count > static_cast<int64_t>(binary_.size())) {
    return GlbFault("an accessor reaches beyond its buffer");
  }
  result.count_ = static_cast<size_t>(count);
  if (accessor.contains("bufferView")) {
    PLEAT_ASSIGN_OR_RETURN(result.data_,
                           Elements(accessor["bufferView"], Size(accessor, "byteOffset", 0), count,
                                    element_bytes, &result.stride_));
  } else if (!accessor.contains("sparse")) {
    return GlbFault(
        "an accessor has no buffer view; if the mesh is compressed, export it without compression");
  }
  if (accessor.contains("sparse")) {
    PLEAT_RETURN_IF_ERROR(ReadSparse(accessor["sparse"], element_bytes, &result));
  }
  return result;
}

absl::StatusOr<const char*> GlbContainer::Elements(const json& view_index, int64_t offset,
                                                   int64_t count, int64_t element_bytes,
                                                   size_t* stride) const {
  const json& view = Entry("bufferViews", view_index);
  if (!view.is_object()) return GlbFault("an accessor's buffer view is missing");
  const json& buffer = Entry("buffers", view.value("buffer", json()));
  if (view.value("buffer", json()) != 0 || !buffer.is_object() || buffer.contains("uri")) {
    return GlbFault("only the file's own binary chunk is read, no other files");
  }
  const int64_t view_offset = Size(view, "byteOffset", 0), view_size = Size(view, "byteLength", -1);
  const int64_t step = Size(view, "byteStride", element_bytes);
  if (offset < 0 || view_offset < 0 || view_size < 0 || step < 1 ||
      view_offset > static_cast<int64_t>(binary_.size()) ||
      view_size > static_cast<int64_t>(binary_.size()) - view_offset || offset > view_size ||
      element_bytes > view_size - offset ||
      (count - 1) > (view_size - offset - element_bytes) / step) {
    return GlbFault("an accessor reaches beyond its buffer");
  }
  *stride = static_cast<size_t>(step);
  return binary_.data() + view_offset + offset;
}

absl::Status GlbContainer::ReadSparse(const json& sparse, int64_t element_bytes,
                                      GlbAccessor* accessor) const {
  const json indices = sparse.is_object() ? sparse.value("indices", json()) : json();
  const json values = sparse.is_object() ? sparse.value("values", json()) : json();
  if (!indices.is_object() || !values.is_object()) {
    return GlbFault("a sparse accessor lacks its indices or values");
  }
  const int64_t count = Size(sparse, "count", -1);
  const int64_t index_type = Size(indices, "componentType", 0);
  if (count < 1 || count > static_cast<int64_t>(accessor->count_) ||
      (index_type != kUnsignedByte && index_type != kUnsignedShort && index_type != kUnsignedInt)) {
    return GlbFault("a sparse accessor has a bad count or type of its indices");
  }
  accessor->sparse_index_type_ = static_cast<int>(index_type);
  const auto index_bytes = static_cast<int64_t>(ComponentBytes(accessor->sparse_index_type_));
  size_t index_stride = 0, value_stride = 0;
  PLEAT_ASSIGN_OR_RETURN(accessor->sparse_indices_, Elements(indices.value("bufferView", json()),
                                                             Size(indices, "byteOffset", 0), count,
                                                             index_bytes, &index_stride));
  PLEAT_ASSIGN_OR_RETURN(accessor->sparse_values_,
                         Elements(values.value("bufferView", json()), Size(values, "byteOffset", 0),
                                  count, element_bytes, &value_stride));
  if (static_cast<int64_t>(index_stride) != index_bytes ||
      static_cast<int64_t>(value_stride) != element_bytes) {
    return GlbFault("the buffer views of a sparse accessor must not have a byteStride");
  }
  accessor->num_sparse_ = static_cast<size_t>(count);
  for (size_t i = 0; i < accessor->num_sparse_; ++i) {
    const size_t index = LoadIndex(accessor->sparse_indices_, accessor->sparse_index_type_, i);
    if (index >= accessor->count_ ||
        (i > 0 &&
         index <= LoadIndex(accessor->sparse_indices_, accessor->sparse_index_type_, i - 1))) {
      return GlbFault("the indices of a sparse accessor must ascend and be its elements");
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
