// The numbers in file names.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pleat {

// <0, 0, >0 by natural order; leading zeros do not count.
int CompareNaturally(std::string_view a, std::string_view b);

// A path taken apart: "walk2/f_007.obj" has the pattern "walk#/f_#.obj" (with a NUL for each #) and
// the numbers {2, 7}.
struct NameParts {
  std::string path;
  std::string pattern;
  std::vector<int64_t> numbers;
};

// By pattern, each in the order of its numbers. A minus sign that no letter or digit precedes is
// the sign of its number; so is any other where names without it exist ("f-1" beside "f0").
using SeriesMap = std::map<std::string, std::vector<NameParts>>;
SeriesMap GroupByPattern(const std::vector<std::string>& paths);

// The position of the one number in which the names differ, if there is exactly one.
std::optional<size_t> CountingPosition(const std::vector<NameParts>& names);

}  // namespace pleat
