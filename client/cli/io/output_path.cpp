#include "cli/io/output_path.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "cli/exit_code.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

std::string EndingOf(const std::string& path) { return fs::path(path).extension().string(); }

absl::Status UnknownEnding(const std::string& flag, const std::string& path,
                           const std::string& known) {
  return UsageError(absl::StrCat(flag, " '", path, "': the ending '", EndingOf(path),
                                 "' is unknown here; known: ", known));
}

absl::Status CheckEnding(const OutputFile& file) {
  const std::string ending = EndingOf(file.path);
  if (ending.empty() || std::ranges::count(file.endings, ending) > 0) return absl::OkStatus();
  return UnknownEnding(file.flag, file.path, absl::StrJoin(file.endings, ", "));
}

// WriteFile replaces whatever has the name, so a link counts as existing even when it leads
// nowhere, and a device would be lost.
absl::Status CheckReplaced(const Session& session, const std::string& flag,
                           const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(path, ignored))) return absl::OkStatus();
  const fs::file_status target = fs::status(path, ignored);
  if (fs::exists(target) && !fs::is_regular_file(target)) {
    return UsageError(absl::StrCat(flag, ": '", path, "' exists and is no regular file"));
  }
  if (session.force) return absl::OkStatus();
  return UsageError(
      absl::StrCat(flag, ": the file '", path, "' exists; --force replaces existing files"));
}

bool IsFolder(const std::string& path) {
  std::error_code ignored;
  return absl::EndsWith(path, "/") || fs::is_directory(path, ignored);
}

// Two names of one file that does not exist yet, such as "x" and "./x", count as the same.
std::string Normal(const std::string& path) {
  std::error_code error;
  const fs::path normal = fs::weakly_canonical(path, error);
  return error ? path : normal.string();
}

absl::Status CheckContents(const Session& session, const std::string& flag,
                           const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return absl::OkStatus();
  if (!fs::is_directory(status)) {
    return UsageError(absl::StrCat(flag, ": '", path, "' exists and is no folder"));
  }
  if (session.force || fs::is_empty(path, error) || error) return absl::OkStatus();
  return UsageError(absl::StrCat(flag, ": the folder '", path,
                                 "' is not empty; --force writes into it and replaces files"));
}

}  // namespace

absl::Status CheckOutputFiles(const Session& session, const std::vector<OutputFile>& files) {
  for (size_t i = 0; i < files.size(); ++i) {
    if (files[i].path.empty()) continue;
    PLEAT_RETURN_IF_ERROR(CheckEnding(files[i]));
    PLEAT_RETURN_IF_ERROR(CheckReplaced(session, files[i].flag, files[i].path));
    for (size_t k = 0; k < i; ++k) {
      if (files[k].path.empty() || Normal(files[k].path) != Normal(files[i].path)) continue;
      return UsageError(absl::StrCat(files[k].flag, " and ", files[i].flag, " are the same file, '",
                                     files[i].path, "'"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckOutputFolder(const Session& session, const std::string& flag,
                               const std::string& path) {
  // "take.2" is a name as good as any; "take.glb" would be a folder where a file was meant.
  const std::string ending = EndingOf(path);
  if (ending.size() > 1 && absl::ascii_isalpha(ending[1]) && !IsFolder(path)) {
    return UnknownEnding(flag, path, "none, since this is a folder; or write a / at the end");
  }
  return CheckContents(session, flag, path);
}

absl::Status CheckAnimationOutput(const Session& session, const std::string& path,
                                  AnimationFormat format, const std::string& format_name) {
  if (const AnimationFormatInfo& info = InfoOf(format); info.is_file) {
    std::vector<OutputFile> files = {{"-o", path, {"." + info.name}}};
    if (info.has_mesh_beside) {
      files.push_back({"-o", fs::path(path).replace_extension(".obj").string(), {".obj"}});
    }
    return CheckOutputFiles(session, files);
  }
  if (format_name != "auto" && EndingOf(path) == "." + format_name) {
    return CheckContents(session, "-o", path);
  }
  if (format_name == "auto" && !EndingOf(path).empty() && !IsFolder(path)) {
    return UnknownEnding("-o", path,
                         AnimationEndings() + ", and none for a folder; or write a / at its end");
  }
  return CheckOutputFolder(session, "-o", path);
}

}  // namespace pleat
