#include "cli/batch/batch_report.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/show/text_table.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr char kSchema[] = "pleat.batch/1";
constexpr size_t kShownBytes = 90;  // of a message in the table

// A message without what differs from take to take: numbers, and what is in quotes.
std::string KindOf(const std::string& message) {
  std::string kind;
  for (size_t i = 0; i < message.size(); ++i) {
    const size_t quoted = message[i] == '\'' ? message.find('\'', i + 1) : std::string::npos;
    if (quoted != std::string::npos) {
      kind += "'...'";
      i = quoted;
    } else if (absl::ascii_isdigit(static_cast<unsigned char>(message[i]))) {
      if (kind.empty() || kind.back() != 'N') kind.push_back('N');
    } else {
      kind.push_back(message[i]);
    }
  }
  return kind;
}

std::string KeyOf(const std::string& name, const std::string& fingerprint) {
  return absl::StrCat(fingerprint, " ", name);
}

// Inputs that are refused come before what an operator can mend.
int RankOf(absl::StatusCode code) {
  switch (ExitCodeOf(absl::Status(code, ""))) {
    case ExitCode::kRefused:
      return 0;
    case ExitCode::kBadInput:
      return 1;
    case ExitCode::kNotFound:
      return 2;
    case ExitCode::kLimit:
      return 3;
    default:
      return 4;
  }
}

}  // namespace

std::string FormatBatchRow(const BatchRow& row) {
  nlohmann::ordered_json json = {{"schema", kSchema},
                                 {"name", ToValidUtf8(row.name)},
                                 {"inputs", nlohmann::json::array()},
                                 {"fingerprint", row.fingerprint},
                                 {"status", row.status.ok() ? "ok" : "failed"},
                                 {"sequence_ids", row.sequence_ids},
                                 {"job_id", row.job_id},
                                 {"result_id", row.result_id},
                                 {"output", ToValidUtf8(row.output)},
                                 {"num_frames", row.num_frames},
                                 {"num_vertices", row.num_vertices},
                                 {"seconds", row.seconds}};
  for (const std::string& input : row.inputs) json["inputs"].push_back(ToValidUtf8(input));
  if (row.mean_error_mm >= 0) json["mean_error_mm"] = row.mean_error_mm;
  if (!row.status.ok()) {
    json["code"] = absl::StatusCodeToString(row.status.code());
    json["code_number"] = static_cast<int>(row.status.code());
    json["message"] = ToValidUtf8(std::string(row.status.message()));
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

absl::StatusOr<BatchRow> ParseBatchRow(const std::string& line) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  const absl::Status wrong = absl::DataLossError("it is no row of pleat.batch/1");
  if (!json.is_object() || json.value("schema", nlohmann::json()) != kSchema) return wrong;
  try {
    BatchRow row;
    row.name = json.at("name").get<std::string>();
    row.inputs = json.at("inputs").get<std::vector<std::string>>();
    row.fingerprint = json.at("fingerprint").get<std::string>();
    row.sequence_ids = json.at("sequence_ids").get<std::vector<std::string>>();
    row.job_id = json.at("job_id").get<std::string>();
    row.result_id = json.at("result_id").get<std::string>();
    row.output = json.at("output").get<std::string>();
    row.num_frames = json.at("num_frames").get<int>();
    row.num_vertices = json.at("num_vertices").get<int>();
    row.seconds = json.at("seconds").get<double>();
    row.mean_error_mm = json.value("mean_error_mm", -1.);
    if (json.at("status") != "ok") {
      row.status = absl::Status(static_cast<absl::StatusCode>(json.at("code_number").get<int>()),
                                json.at("message").get<std::string>());
      if (row.status.ok()) return wrong;
    }
    return row;
  } catch (const nlohmann::json::exception&) {
    return wrong;
  }
}

absl::StatusOr<std::unique_ptr<BatchReport>> BatchReport::Open(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) return ErrnoStatus(errno, absl::StrCat("cannot write ", path));
  std::unique_ptr<BatchReport> report(new BatchReport(descriptor));
  PLEAT_RETURN_IF_ERROR(report->Read(path));
  return report;
}

BatchReport::~BatchReport() { close(descriptor_); }

absl::Status BatchReport::Read(const std::string& path) {
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  size_t begin = 0;
  for (int line = 1; begin < text.size(); ++line) {
    const size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;  // cut off by a crash
    const absl::StatusOr<BatchRow> row = ParseBatchRow(text.substr(begin, end - begin));
    if (!row.ok()) {
      return absl::DataLossError(absl::StrCat(path, ", line ", line, ": ", row.status().message(),
                                              "; choose another --report"));
    }
    Note(*row);
    begin = end + 1;
  }
  if (ftruncate(descriptor_, static_cast<off_t>(begin)) != 0 ||
      lseek(descriptor_, 0, SEEK_END) < 0) {
    return ErrnoStatus(errno, absl::StrCat("cannot write ", path));
  }
  return absl::OkStatus();
}

void BatchReport::Note(const BatchRow& row) {
  Seen& seen = seen_[KeyOf(row.name, row.fingerprint)];
  seen.done |= row.status.ok();
  seen.num_failures += row.status.ok() ? 0 : 1;
}

bool BatchReport::IsDone(const std::string& name, const std::string& fingerprint) const {
  std::lock_guard lock(mutex_);
  const auto seen = seen_.find(KeyOf(name, fingerprint));
  return seen != seen_.end() && seen->second.done;
}

int BatchReport::NumFailures(const std::string& name, const std::string& fingerprint) const {
  std::lock_guard lock(mutex_);
  const auto seen = seen_.find(KeyOf(name, fingerprint));
  return seen == seen_.end() ? 0 : seen->second.num_failures;
}

absl::Status BatchReport::Add(const BatchRow& row) {
  const std::string line = FormatBatchRow(row) + "\n";
  std::lock_guard lock(mutex_);
  for (size_t done = 0; done < line.size();) {
    const ssize_t count = write(descriptor_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return ErrnoStatus(errno, "cannot write the report of the batch");
    done += static_cast<size_t>(count);
  }
  Note(row);
  return absl::OkStatus();
}

std::string BatchErrorTable(const std::vector<BatchRow>& rows) {
  struct Group {
    int count = 0;
    const BatchRow* first = nullptr;
  };
  std::map<std::pair<int, std::string>, Group> groups;
  for (const BatchRow& row : rows) {
    if (row.status.ok()) continue;
    Group& group = groups[{RankOf(row.status.code()), KindOf(std::string(row.status.message()))}];
    if (group.count++ == 0) group.first = &row;
  }
  if (groups.empty()) return "";
  std::vector<std::pair<int, Group>> sorted;
  for (const auto& [key, group] : groups) sorted.emplace_back(key.first, group);
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.count > b.second.count;
  });
  std::vector<std::vector<std::string>> cells;
  for (const auto& [rank, group] : sorted) {
    std::string message = EscapeControls(std::string(group.first->status.message()));
    if (message.size() > kShownBytes) {
      message = ToValidUtf8(std::string_view(message).substr(0, kShownBytes)) + "...";
    }
    cells.push_back({message, group.first->name, absl::StrCat(group.count)});
  }
  return FormatTable({"why", "for example", "takes"}, cells);
}

}  // namespace pleat
