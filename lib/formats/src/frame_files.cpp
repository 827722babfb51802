#include "pleat/formats/frame_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Returns the digits at the front of `text` without leading zeros. `num_read` counts these too.
std::string_view LeadingNumber(std::string_view text, size_t* num_read) {
  size_t end = 0;
  while (end < text.size() && IsDigit(text[end])) ++end;
  *num_read = end;
  size_t begin = 0;
  while (begin + 1 < end && text[begin] == '0') ++begin;
  return text.substr(begin, end - begin);
}

// Returns a number below, equal to or above 0. Leading zeros do not count.
int CompareNaturally(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a[0]) && IsDigit(b[0])) {
      size_t num_a = 0, num_b = 0;
      const std::string_view x = LeadingNumber(a, &num_a), y = LeadingNumber(b, &num_b);
      if (x.size() != y.size()) return x.size() < y.size() ? -1 : 1;
      if (const int order = x.compare(y); order != 0) return order;
      a.remove_prefix(num_a);
      b.remove_prefix(num_b);
    } else {
      if (a[0] != b[0]) return static_cast<uint8_t>(a[0]) < static_cast<uint8_t>(b[0]) ? -1 : 1;
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return static_cast<int>(!a.empty()) - static_cast<int>(!b.empty());
}

// A path taken apart: "walk2/f_007.obj" has the pattern "walk#/f_#" and the numbers {2, 7}.
struct NameParts {
  std::string path;
  std::string pattern;
  std::vector<uint64_t> numbers;
};

NameParts TakeApart(const std::string& path) {
  NameParts parts{path, "", {}};
  const std::string stem = std::filesystem::path(path).replace_extension().string();
  for (size_t i = 0; i < stem.size();) {
    if (!IsDigit(stem[i])) {
      parts.pattern.push_back(stem[i++]);
      continue;
    }
    uint64_t number = 0;
    for (; i < stem.size() && IsDigit(stem[i]); ++i) {
      number = number * 10 + static_cast<uint64_t>(stem[i] - '0');
    }
    parts.pattern.push_back('#');
    parts.numbers.push_back(number);
  }
  return parts;
}

std::string FileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

// Returns the position of the one number in which the names differ, if there is exactly one.
std::optional<size_t> CountingPosition(const std::vector<NameParts>& names) {
  std::optional<size_t> position;
  for (size_t i = 0; i < names[0].numbers.size(); ++i) {
    const bool varies = std::any_of(names.begin(), names.end(), [&](const NameParts& name) {
      return name.numbers[i] != names[0].numbers[i];
    });
    if (!varies) continue;
    if (position) return std::nullopt;
    position = i;
  }
  return position;
}

absl::Status CheckDoubled(const std::vector<NameParts>& names) {
  for (size_t i = 1; i < names.size(); ++i) {
    if (!names[i].numbers.empty() && names[i].numbers == names[i - 1].numbers) {
      return absl::InvalidArgumentError(absl::StrCat(
          "frame number ", names[i].numbers.back(), " is there twice: '",
          FileName(names[i - 1].path), "' and '", FileName(names[i].path), "'; remove one"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckMissing(const std::vector<NameParts>& names, size_t position) {
  // The step is the smallest distance between two numbers. Two files alone say nothing about a
  // step, so their numbers must follow each other.
  uint64_t step = names.size() == 2 ? 1 : ~uint64_t{0};
  for (size_t i = 1; i < names.size() && names.size() > 2; ++i) {
    step = std::min(step, names[i].numbers[position] - names[i - 1].numbers[position]);
  }
  for (size_t i = 1; i < names.size(); ++i) {
    const uint64_t previous = names[i - 1].numbers[position];
    if (names[i].numbers[position] - previous != step) {
      return absl::InvalidArgumentError(absl::StrCat(
          "frame number ", previous + step, " is missing between '", FileName(names[i - 1].path),
          "' and '", FileName(names[i].path), "'; add it or renumber the files"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  const int order = CompareNaturally(a, b);
  return order != 0 ? order < 0 : a < b;
}

absl::Status SortFrameFiles(std::vector<std::string>* paths) {
  std::sort(paths->begin(), paths->end(),
            [](const std::string& a, const std::string& b) { return NaturalLess(a, b); });
  // The longest series is the one that is meant; anything beside it is a stray file.
  std::map<std::string, std::vector<NameParts>> series;  // the files of each pattern
  for (const std::string& path : *paths) {
    NameParts parts = TakeApart(path);
    series[parts.pattern].push_back(std::move(parts));
  }
  const auto longest = std::max_element(
      series.begin(), series.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (longest == series.end() || longest->second.size() < 2) return absl::OkStatus();
  for (const auto& [pattern, names] : series) {
    if (pattern != longest->first) {
      return absl::InvalidArgumentError(absl::StrCat(
          "'", FileName(names[0].path), "' does not belong to the series '",
          FileName(longest->second[0].path), "' ... '", FileName(longest->second.back().path),
          "' beside it; move it away or choose the frames with a pattern such as "
          "\"folder/name_*\""));
    }
  }
  if (absl::Status status = CheckDoubled(longest->second); !status.ok()) return status;
  const std::optional<size_t> position = CountingPosition(longest->second);
  return position ? CheckMissing(longest->second, *position) : absl::OkStatus();
}

}  // namespace pleat
