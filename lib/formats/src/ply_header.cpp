#include "ply_header.h"

#include <charconv>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kMaxHeaderLines = 10'000;
constexpr size_t kMaxProperties = 1'000;  // in one element

std::optional<PlyScalar> ScalarFromName(std::string_view name) {
  constexpr std::pair<std::string_view, PlyScalar> kNames[] = {
      {"char", PlyScalar::kInt8},      {"int8", PlyScalar::kInt8},
      {"uchar", PlyScalar::kUint8},    {"uint8", PlyScalar::kUint8},
      {"short", PlyScalar::kInt16},    {"int16", PlyScalar::kInt16},
      {"ushort", PlyScalar::kUint16},  {"uint16", PlyScalar::kUint16},
      {"int", PlyScalar::kInt32},      {"int32", PlyScalar::kInt32},
      {"uint", PlyScalar::kUint32},    {"uint32", PlyScalar::kUint32},
      {"float", PlyScalar::kFloat32},  {"float32", PlyScalar::kFloat32},
      {"double", PlyScalar::kFloat64}, {"float64", PlyScalar::kFloat64}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

// The lines of the header. When the first one ends with a bare CR, the header was written with
// those, and an LF behind the last of them is the first byte of a binary body.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view bytes)
      : bytes_(bytes), begin_(bytes.starts_with("\xef\xbb\xbf") ? 3 : 0) {
    const size_t end = bytes_.find_first_of("\r\n");
    has_bare_cr_ = end != std::string_view::npos && bytes_[end] == '\r' &&
                   (end + 1 == bytes_.size() || bytes_[end + 1] != '\n');
  }
  std::optional<std::string_view> Next() {
    const size_t end = bytes_.find_first_of(has_bare_cr_ ? "\r\n" : "\n", begin_);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = bytes_.substr(begin_, end - begin_);
    begin_ = end + 1;
    return line;
  }
  size_t body_offset() const { return begin_; }

 private:
  std::string_view bytes_;
  size_t begin_;
  bool has_bare_cr_ = false;
};

std::vector<std::string_view> SplitWords(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kSpace = " \t\r";
  for (size_t begin = line.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
  return words;
}

std::optional<int64_t> CountFromText(std::string_view text) {
  int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count < 0) return std::nullopt;
  return count;
}

// Each function Parse... returns what is wrong with the line, or an empty string.
std::string ParseFormat(const std::vector<std::string_view>& words, PlyHeader* header) {
  if (words.size() >= 2 && words[1] == "ascii") {
    header->encoding = PlyEncoding::kAscii;
  } else if (words.size() >= 2 && words[1] == "binary_little_endian") {
    header->encoding = PlyEncoding::kLittleEndian;
  } else if (words.size() >= 2 && words[1] == "binary_big_endian") {
    header->encoding = PlyEncoding::kBigEndian;
  } else {
    return "the format must be ascii, binary_little_endian or binary_big_endian";
  }
  return "";
}

std::string ParseElement(const std::vector<std::string_view>& words, PlyHeader* header) {
  const std::optional<int64_t> count =
      words.size() == 3 ? CountFromText(words[2]) : std::optional<int64_t>();
  if (!count) return "expected 'element NAME COUNT'";
  header->elements.push_back({std::string(words[1]), *count, {}});
  return "";
}

std::string ParseProperty(const std::vector<std::string_view>& words, PlyHeader* header) {
  if (header->elements.empty()) return "a property before the first element";
  PlyProperty property;
  property.is_list = words.size() == 5 && words[1] == "list";
  if (!property.is_list && words.size() != 3) {
    return "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'";
  }
  const std::optional<PlyScalar> type = ScalarFromName(words[words.size() - 2]);
  const std::optional<PlyScalar> size_type = ScalarFromName(words[property.is_list ? 2 : 1]);
  if (!type || !size_type) return "unknown property type";
  if (property.is_list && *size_type >= PlyScalar::kFloat32) {
    return "the length of a list must be an integer";
  }
  property.name = std::string(words.back());
  property.type = *type;
  property.size_type = *size_type;
  if (header->elements.back().properties.size() >= kMaxProperties) return "too many properties";
  header->elements.back().properties.push_back(std::move(property));
  return "";
}

}  // namespace

int PlyScalarBytes(PlyScalar type) {
  constexpr int kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(type)];
}

int PlyElement::FindProperty(std::string_view property_name) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property_name) return static_cast<int>(i);
  }
  return -1;
}

absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file) {
  PlyHeader header;
  bool has_format = false;
  HeaderLines lines(bytes);
  while (header.num_lines < kMaxHeaderLines) {
    const std::optional<std::string_view> line = lines.Next();
    if (!line) break;
    const std::vector<std::string_view> words = SplitWords(*line);
    ++header.num_lines;
    std::string fault;
    const std::string_view keyword = words.empty() ? "" : words[0];
    if (header.num_lines == 1) {
      if (keyword != "ply") fault = "a PLY file begins with the line 'ply'";
    } else if (keyword == "format") {
      has_format = true;
      fault = ParseFormat(words, &header);
    } else if (keyword == "element") {
      fault = ParseElement(words, &header);
    } else if (keyword == "property") {
      fault = ParseProperty(words, &header);
    } else if (keyword == "end_header") {
      header.body_offset = lines.body_offset();
      if (has_format) return header;
      fault = "the header names no format";
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      fault = "unknown header line";
    }
    if (!fault.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(file, ":", header.num_lines, ": ", fault));
    }
  }
  return absl::InvalidArgumentError(
      absl::StrCat(file, ": no 'end_header' line: the file is cut off or not a PLY file"));
}

}  // namespace pleat
