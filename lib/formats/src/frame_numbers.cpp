#include "frame_numbers.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"

namespace pleat {
namespace {

constexpr size_t kMaxDigits = 18;  // more do not fit in 63 bits and are part of the name

// Stands for a number in a pattern: no path holds it.
constexpr char kNumber = '\0';

bool IsDigit(char c) { return absl::ascii_isdigit(static_cast<unsigned char>(c)); }
bool IsAlphanumeric(char c) { return absl::ascii_isalnum(static_cast<unsigned char>(c)); }

size_t NumDigits(std::string_view text) {
  size_t end = 0;
  while (end < text.size() && IsDigit(text[end])) ++end;
  return end;
}

// The digits at the front of `text` without leading zeros.
std::string_view LeadingNumber(std::string_view text, size_t* num_read) {
  *num_read = NumDigits(text);
  size_t begin = 0;
  while (begin + 1 < *num_read && text[begin] == '0') ++begin;
  return text.substr(begin, *num_read - begin);
}

NameParts TakeApart(const std::string& path) {
  NameParts parts{path, "", {}};
  const std::filesystem::path as_path(path);
  const std::string stem = std::filesystem::path(path).replace_extension().string();
  for (size_t i = 0; i < stem.size();) {
    size_t num_read = 0;
    const std::string_view digits = LeadingNumber(std::string_view(stem).substr(i), &num_read);
    if (num_read == 0) {
      parts.pattern.push_back(stem[i] == kNumber ? ' ' : stem[i]);
      ++i;
      continue;
    }
    if (digits.size() > kMaxDigits) {
      parts.pattern.append(stem, i, num_read);
      i += num_read;
      continue;
    }
    int64_t number = 0;
    for (const char c : digits) number = number * 10 + (c - '0');
    const size_t length = parts.pattern.size();
    if (length > 0 && parts.pattern.back() == '-' &&
        (length == 1 ||
         !(IsAlphanumeric(parts.pattern[length - 2]) || parts.pattern[length - 2] == kNumber))) {
      parts.pattern.pop_back();
      number = -number;
    }
    parts.pattern.push_back(kNumber);
    parts.numbers.push_back(number);
    i += num_read;
  }
  // The sign of a number must stand for numbers alone, in the ending too.
  std::string ending = absl::AsciiStrToLower(as_path.extension().string());
  std::ranges::replace(ending, kNumber, ' ');
  parts.pattern += ending;
  return parts;
}

// Joins "f-#" to "f#", where both are there.
void JoinNegativeNumbers(SeriesMap* series) {
  for (auto entry = series->begin(); entry != series->end();) {
    auto target = series->end();
    size_t position = 0;  // of the number that has the sign
    for (size_t i = 0, number = 0; i + 1 < entry->first.size(); ++i) {
      if (entry->first[i] == '-' && entry->first[i + 1] == kNumber && target == series->end()) {
        target = series->find(std::string(entry->first).erase(i, 1));
        position = number;
      }
      number += entry->first[i] == kNumber;
    }
    if (target == series->end()) {
      ++entry;
      continue;
    }
    for (NameParts& name : entry->second) {
      name.numbers[position] = -name.numbers[position];
      target->second.push_back(std::move(name));
    }
    entry = series->erase(entry);
  }
}

}  // namespace

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

SeriesMap GroupByPattern(const std::vector<std::string>& paths) {
  SeriesMap series;
  for (const std::string& path : paths) {
    NameParts parts = TakeApart(path);
    series[parts.pattern].push_back(std::move(parts));
  }
  JoinNegativeNumbers(&series);
  for (auto& [pattern, names] : series) {
    std::stable_sort(names.begin(), names.end(), [](const NameParts& a, const NameParts& b) {
      return a.numbers != b.numbers ? a.numbers < b.numbers : a.path < b.path;
    });
  }
  return series;
}

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

}  // namespace pleat
