#include "pleat/formats/vertex_channel.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "json_depth.h"
#include "npy_array.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

absl::Status CheckCount(size_t count, const MeshLimits& limits) {
  if (count == 0) return absl::InvalidArgumentError("the channel has no numbers");
  if (static_cast<int64_t>(count) <= limits.max_vertices) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(
      "the channel has ", count, " numbers, the limit on vertices is ", limits.max_vertices));
}

absl::StatusOr<std::vector<float>> NumbersOfNpy(std::string_view bytes, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const NpyArray array, ParseNpy(bytes));
  const std::vector<int64_t>& shape = array.shape;
  const bool is_list = shape.size() == 1 || (shape.size() == 2 && shape[1] == 1);
  if (!is_list || !(array.is_float() || array.is_integer())) {
    return absl::InvalidArgumentError(absl::StrCat("the array is ", DescribeNpy(array),
                                                   " in place of one number for each vertex"));
  }
  PLEAT_RETURN_IF_ERROR(CheckCount(static_cast<size_t>(array.num_items()), limits));
  std::vector<float> numbers;
  for (int64_t i = 0; i < array.num_items(); ++i) {
    numbers.push_back(static_cast<float>(NpyNumber(array, i)));
  }
  return numbers;
}

absl::StatusOr<std::vector<float>> NumbersOfJson(std::string_view text, const MeshLimits& limits) {
  if (NestsTooDeep(text, 4)) return absl::InvalidArgumentError("the channel is no JSON list");
  const json root = json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
  if (!root.is_array()) return absl::InvalidArgumentError("the channel is no JSON list");
  PLEAT_RETURN_IF_ERROR(CheckCount(root.size(), limits));
  std::vector<float> numbers;
  for (const json& value : root) {
    numbers.push_back(value.is_number() ? value.get<float>() : std::nanf(""));
  }
  return numbers;
}

}  // namespace

absl::StatusOr<std::vector<float>> DecodeVertexChannel(std::string_view bytes,
                                                       const MeshLimits& limits) {
  if (bytes.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the channel has ", bytes.size(), " bytes, the limit is ", limits.max_document_bytes));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<float> numbers, bytes.starts_with("\x93NUMPY")
                                                               ? NumbersOfNpy(bytes, limits)
                                                               : NumbersOfJson(bytes, limits));
  for (size_t v = 0; v < numbers.size(); ++v) {
    if (!std::isfinite(numbers[v])) {
      return absl::InvalidArgumentError(
          absl::StrCat("the channel has no finite number for vertex ", v));
    }
  }
  return numbers;
}

absl::StatusOr<std::vector<float>> ReadVertexChannel(const std::string& path,
                                                     const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_document_bytes));
  return WithContext(path, DecodeVertexChannel(bytes, limits));
}

}  // namespace pleat
