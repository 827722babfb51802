// Values of USD text.
#pragma once

#include <Eigen/Core>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pleat {

// The shortest digits that read back as the same value.
template <typename T>
void AppendDigits(T value, std::string* text) {
  char buffer[32];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  text->append(buffer, result.ptr);
}

void AppendTuple(const float* values, int count, std::string* text);
void AppendPoints(const Eigen::Matrix3Xf& points, std::string* text);
void AppendIntegers(const std::vector<int32_t>& values, std::string* text);

// A text in quotes; what cannot stand there is escaped.
std::string QuotedText(std::string_view text);

// A name that a prim may have: letters, digits and _ of ASCII, no digit at the front. `otherwise`
// is taken for an empty one.
std::string PrimName(std::string_view name, const char* otherwise);

// What the file says of its space and its timeline, for the head of a stage.
struct UsdaStage {
  std::string default_prim;
  double meters_per_unit = 1;
  bool is_z_up = false;
  double first_frame = 0, last_frame = 0, fps = 30;
};
void AppendUsdaHead(const UsdaStage& stage, std::string* text);

}  // namespace pleat
