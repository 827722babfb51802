// Khronos, glTF 2.0 specification, sections 3.6.1 (buffers) and 4.4 (binary files).
#include "gltf_file.h"

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "glb_container.h"
#include "json_depth.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

absl::Status GltfFault(const std::string& what) {
  return absl::InvalidArgumentError(
      absl::StrCat("glTF: ", what, "; export as GLB to have all in one file"));
}

// %20 and the like.
std::string PercentDecoded(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    const std::string_view digits = uri[i] == '%' ? uri.substr(i + 1, 2) : "";
    uint8_t byte = 0;
    const char* end = digits.data() + digits.size();
    if (digits.size() == 2 && std::from_chars(digits.data(), end, byte, 16).ptr == end) {
      text.push_back(static_cast<char>(byte));
      i += 2;
    } else {
      text.push_back(uri[i]);
    }
  }
  return text;
}

// Below the folder of the document, whatever the name says.
bool IsInside(const std::filesystem::path& name) {
  if (name.empty() || name.is_absolute()) return false;
  for (const std::filesystem::path& part : name.lexically_normal()) {
    if (part == "..") return false;
  }
  return true;
}

absl::StatusOr<std::string> ReadBuffer(const json& buffer, size_t index, const std::string& path,
                                       const MeshLimits& limits) {
  const auto uri = buffer.is_object() ? buffer.find("uri") : buffer.end();
  if (!buffer.is_object() || uri == buffer.end() || !uri->is_string()) {
    return GltfFault(absl::StrCat("buffer ", index, " names no file"));
  }
  const std::string text = uri->get<std::string>();
  if (text.starts_with("data:")) {
    const size_t comma = text.find(";base64,");
    std::string bytes;
    if (comma == std::string::npos || !absl::Base64Unescape(text.substr(comma + 8), &bytes)) {
      return GltfFault(absl::StrCat("buffer ", index, ": its data URI is not base64"));
    }
    return bytes;
  }
  const std::filesystem::path name = PercentDecoded(text);
  if (!IsInside(name)) {
    return GltfFault(absl::StrCat("buffer ", index, " is '", EscapeControls(text),
                                  "', which is not beside the file"));
  }
  absl::StatusOr<std::string> bytes = ReadFile(
      (std::filesystem::path(path).parent_path() / name).string(), limits.max_document_bytes);
  if (absl::IsNotFound(bytes.status())) {
    return GltfFault(absl::StrCat("its buffer '", EscapeControls(text), "' is not beside it"));
  }
  return bytes;
}

// One buffer instead of many: the views move with their bytes.
absl::Status JoinBuffers(const std::string& path, const MeshLimits& limits, json* root,
                         std::string* binary) {
  std::vector<size_t> starts;
  const json buffers = root->value("buffers", json::array());
  if (!buffers.is_array()) return GltfFault("'buffers' is not a list");
  for (const json& buffer : buffers) {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes,
                           ReadBuffer(buffer, starts.size(), path, limits));
    starts.push_back(binary->size());
    binary->append(bytes);
    binary->resize((binary->size() + 3) / 4 * 4);
    if (binary->size() > limits.max_document_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat("glTF: the buffers have more than ", limits.max_document_bytes, " bytes"));
    }
  }
  const auto views = root->find("bufferViews");
  if (views != root->end() && views->is_array()) {
    for (json& view : *views) {
      if (!view.is_object()) return GltfFault("a buffer view is not an object");
      const json buffer = view.value("buffer", json()), offset = view.value("byteOffset", json(0));
      if (!buffer.is_number_integer() || buffer < 0 || buffer >= starts.size() ||
          !offset.is_number_integer() || offset < 0 || offset > int64_t{1} << 40) {
        return GltfFault("a buffer view is outside its buffer");
      }
      view["byteOffset"] = starts[buffer.get<size_t>()] + offset.get<size_t>();
      view["buffer"] = 0;
    }
  }
  (*root)["buffers"] = json::array({json::object({{"byteLength", binary->size()}})});
  return absl::OkStatus();
}

}  // namespace

bool IsGltfText(std::string_view bytes) {
  const size_t begin = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return begin != std::string_view::npos && bytes[begin] == '{' &&
         bytes.find("\"asset\"") != std::string_view::npos &&
         bytes.find("pleat.rig_file") == std::string_view::npos;
}

absl::StatusOr<std::string> PackGltf(std::string_view text, const std::string& path,
                                     const MeshLimits& limits) {
  if (NestsTooDeep(text, kMaxGltfDepth)) {
    return GltfFault(absl::StrCat("nested deeper than ", kMaxGltfDepth, " levels"));
  }
  json root = json::parse(text, nullptr, false);
  if (!root.is_object()) return GltfFault("the file is not a JSON object");
  std::string binary;
  PLEAT_RETURN_IF_ERROR(JoinBuffers(path, limits, &root, &binary));
  std::string document = root.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string bytes = GlbStart(std::move(document), binary.size());
  bytes.append(binary);
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

std::string GlbStart(std::string document, size_t binary_bytes) {
  document.resize((document.size() + 3) / 4 * 4, ' ');
  std::string bytes;
  const auto append = [&](uint64_t value) {
    const auto narrow = static_cast<uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&narrow), sizeof(narrow));
  };
  const uint64_t padded_bytes = (uint64_t{binary_bytes} + 3) / 4 * 4;
  append(kGlbMagic);
  append(2);
  append(28 + document.size() + padded_bytes);
  append(document.size());
  append(kGlbJsonChunk);
  bytes.append(document);
  append(padded_bytes);
  append(kGlbBinaryChunk);
  return bytes;
}

}  // namespace pleat
