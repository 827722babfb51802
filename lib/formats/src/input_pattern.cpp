#include <glob.h>

#include "absl/strings/str_cat.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

std::string Escaped(const std::string& name) {
  std::string escaped;
  for (const char c : name) {
    if (c == '*' || c == '?' || c == '[' || c == ']' || c == '\\') escaped.push_back('\\');
    escaped.push_back(c);
  }
  return escaped;
}

// With brackets alone taken for themselves.
std::string WithLiteralBrackets(const std::string& name) {
  std::string escaped;
  for (const char c : name) {
    if (c == '[' || c == ']') escaped.push_back('\\');
    escaped.push_back(c);
  }
  return escaped;
}

absl::StatusOr<std::vector<std::string>> Expand(const std::string& pattern) {
  glob_t matches{};
  const int result = glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches);
  std::vector<std::string> paths(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  globfree(&matches);
  if (result == 0 || result == GLOB_NOMATCH) return paths;
  if (result == GLOB_NOSPACE) {
    return absl::ResourceExhaustedError(absl::StrCat("'", pattern, "' fits too many files"));
  }
  return absl::InvalidArgumentError(absl::StrCat("cannot look for '", pattern, "'"));
}

}  // namespace

absl::StatusOr<std::vector<std::string>> ExpandPattern(const std::string& pattern) {
  // Folders that are there are taken by name; what follows the first that is not is a pattern.
  fs::path literal, escaped;
  bool is_there = true;
  const fs::path whole(pattern);
  for (const fs::path& part : whole.parent_path()) {
    std::error_code error;
    is_there = is_there && fs::exists(literal / part, error);
    literal /= part;
    escaped /= is_there ? fs::path(Escaped(part.string())) : part;
  }
  const std::string name = whole.filename().string();
  for (const std::string& last : {name, WithLiteralBrackets(name)}) {
    absl::StatusOr<std::vector<std::string>> paths = Expand((escaped / last).string());
    if (!paths.ok() || !paths->empty()) return paths;
  }
  return absl::NotFoundError(
      absl::StrCat("no file matches the pattern '", pattern, "'",
                   pattern.find('[') == std::string::npos
                       ? ""
                       : "; [ ] are pattern signs: write \\[ for a bracket in a name"));
}

}  // namespace pleat
