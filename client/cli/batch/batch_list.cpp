#include "cli/batch/batch_list.h"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxTakes = 1'000'000;
constexpr size_t kMaxNameBytes = 200;

absl::Status LineFault(int line, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, " of the list: ", what));
}

absl::Status TakeJson(const std::string& text, BatchTake* take) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return LineFault(take->line, "it begins with '{' and is no JSON object");
  for (const auto& [key, value] : json.items()) {
    if (key == "name" && value.is_string()) {
      take->name = value.get<std::string>();
    } else if (key == "input" && value.is_string()) {
      take->inputs = {value.get<std::string>()};
    } else if (key == "input" && value.is_array()) {
      for (const nlohmann::json& path : value) {
        if (!path.is_string()) return LineFault(take->line, "\"input\" lists something else");
        take->inputs.push_back(path.get<std::string>());
      }
    } else {
      return LineFault(take->line, absl::StrCat("field '", key,
                                                "': known are \"input\" (a path or a list of "
                                                "paths) and \"name\" (a text)"));
    }
  }
  if (take->inputs.empty()) return LineFault(take->line, "it has no \"input\"");
  return absl::OkStatus();
}

absl::Status CheckName(const BatchTake& take) {
  const std::string& name = take.name;
  const bool is_file_name = !name.empty() && name != "." && name != ".." &&
                            name.size() <= kMaxNameBytes && name.find('/') == std::string::npos &&
                            name.find('\0') == std::string::npos;
  if (is_file_name) return absl::OkStatus();
  return LineFault(take.line, absl::StrCat("'", name,
                                           "' cannot be the name of a file: give a "
                                           "short \"name\" without slashes"));
}

// The name of an input with `num_folders` of the folders above it: "shot01_body".
std::string NameOf(const std::string& input, int num_folders) {
  fs::path path = fs::path(input).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::string name = path.extension().empty() ? path.filename().string() : path.stem().string();
  for (int i = 0; i < num_folders; ++i) {
    path = path.parent_path();
    const std::string folder = path.filename().string();
    if (folder.empty() || folder == "." || folder == "..") break;
    name = absl::StrCat(folder, "_", name);
  }
  return name;
}

// Takes that would have the same name get another folder each, until no two are the same.
absl::Status NameTakes(std::vector<BatchTake>* takes) {
  constexpr int kMaxFolders = 8;
  std::vector<size_t> unnamed;
  for (size_t i = 0; i < takes->size(); ++i) {
    if ((*takes)[i].name.empty()) unnamed.push_back(i);
  }
  for (int num_folders = 0; num_folders <= kMaxFolders && !unnamed.empty(); ++num_folders) {
    for (const size_t i : unnamed) {
      (*takes)[i].name = NameOf((*takes)[i].inputs.front(), num_folders);
    }
    std::map<std::string, int> count;
    for (const BatchTake& take : *takes) ++count[take.name];
    std::erase_if(unnamed, [&](size_t i) { return count[(*takes)[i].name] == 1; });
  }
  std::map<std::string, int> line_of;
  for (const BatchTake& take : *takes) {
    PLEAT_RETURN_IF_ERROR(CheckName(take));
    const auto [place, is_new] = line_of.emplace(take.name, take.line);
    if (is_new) continue;
    return LineFault(take.line, absl::StrCat("its name '", take.name, "' is that of line ",
                                             place->second, ": give one of them a \"name\""));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<BatchTake>> ParseBatchList(std::string_view text,
                                                      const std::string& folder) {
  std::vector<BatchTake> takes;
  int line = 0;
  for (const absl::string_view raw :
       absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++line;
    const std::string entry(absl::StripAsciiWhitespace(raw));
    if (entry.empty() || entry.front() == '#') continue;
    if (takes.size() == kMaxTakes) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the list has more than ", kMaxTakes, " takes: make several of it"));
    }
    BatchTake take{.name = {}, .inputs = {}, .line = line};
    if (entry.front() == '{') {
      PLEAT_RETURN_IF_ERROR(TakeJson(entry, &take));
    } else {
      take.inputs = {entry};
    }
    for (std::string& input : take.inputs) {
      if (fs::path(input).is_relative()) input = (fs::path(folder) / input).string();
    }
    takes.push_back(std::move(take));
  }
  if (takes.empty()) return absl::InvalidArgumentError("the list names no takes");
  PLEAT_RETURN_IF_ERROR(NameTakes(&takes));
  return takes;
}

}  // namespace pleat
