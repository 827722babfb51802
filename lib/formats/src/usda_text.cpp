#include "usda_text.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace pleat {

void AppendTuple(const float* values, int count, std::string* text) {
  for (int k = 0; k < count; ++k) {
    text->append(k == 0 ? "(" : ", ");
    AppendDigits(values[k], text);
  }
  text->push_back(')');
}

void AppendPoints(const Eigen::Matrix3Xf& points, std::string* text) {
  text->push_back('[');
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    if (v > 0) text->append(", ");
    AppendTuple(points.data() + 3 * v, 3, text);
  }
  text->push_back(']');
}

void AppendIntegers(const std::vector<int32_t>& values, std::string* text) {
  for (size_t i = 0; i < values.size(); ++i) {
    text->append(i == 0 ? "[" : ", ");
    AppendDigits(values[i], text);
  }
  text->append(values.empty() ? "[]" : "]");
}

// A text in quotes; what cannot stand there is escaped.
std::string QuotedText(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted.push_back('\\');
    quoted.push_back(c == '\n' || c == '\r' || c == '\0' ? ' ' : c);
  }
  return quoted + "\"";
}

// A name that a prim may have: letters, digits and _ of ASCII, no digit at the front.
std::string PrimName(std::string_view name, const char* otherwise) {
  std::string result;
  for (const char c : name.substr(0, 200)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80) continue;  // the rest of a letter beyond ASCII
    result.push_back(absl::ascii_isalnum(byte) ? c : '_');
  }
  if (result.empty()) return otherwise;
  return absl::ascii_isdigit(static_cast<unsigned char>(result[0])) ? "_" + result : result;
}

void AppendUsdaHead(const UsdaStage& stage, std::string* text) {
  const auto setting = [&](const char* name, double value) {
    absl::StrAppend(text, "    ", name, " = ");
    AppendDigits(value, text);
    text->push_back('\n');
  };
  absl::StrAppend(text, "#usda 1.0\n(\n    defaultPrim = \"", stage.default_prim,
                  "\"\n    doc = \"Written by Pleat\"\n");
  setting("endTimeCode", stage.last_frame);
  setting("framesPerSecond", stage.fps);
  setting("metersPerUnit", stage.meters_per_unit);
  setting("startTimeCode", stage.first_frame);
  setting("timeCodesPerSecond", stage.fps);
  absl::StrAppend(text, "    upAxis = \"", stage.is_z_up ? "Z" : "Y", "\"\n)\n\n");
}

}  // namespace pleat
