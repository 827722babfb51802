#include "pleat/formats/frame_files.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "frame_numbers.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

// Seconds since 1970 have ten digits; nobody has that many frames.
constexpr int64_t kLeastTimeStamp = 1'000'000'000;
constexpr int kMaxNamedGaps = 4;
// How many frames there are for each other numbered file that is left out. Fewer may be a second
// series.
constexpr size_t kFramesPerStranger = 10;

std::string Quoted(const std::string& path) {
  return absl::StrCat("'", EscapeControls(std::filesystem::path(path).filename().string()), "'");
}

bool HasNumber(const std::string& path) {
  return std::ranges::any_of(std::filesystem::path(path).stem().string(), [](char c) {
    return absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
}

InputNote AboutTheSeries(const char* kind, std::string text) {
  return {.kind = kind, .text = std::move(text), .refused_when_strict = true};
}

std::string Describe(const std::vector<NameParts>& names) {
  return absl::StrCat("the series ", Quoted(names[0].path), " ... ", Quoted(names.back().path));
}

// Says which files are left out, or refuses when they may be meant.
absl::Status LeaveOutStrangers(const SeriesMap& series, const std::vector<NameParts>& frames,
                               std::vector<InputNote>* notes) {
  std::vector<const NameParts*> strangers;
  bool may_be_meant = false;
  for (const auto& [pattern, names] : series) {
    if (&names == &frames) continue;
    strangers.push_back(&names[0]);
    may_be_meant |= names.size() > 1 || (HasNumber(names[0].path) &&
                                         frames.size() < kFramesPerStranger * series.size());
  }
  if (strangers.empty()) return absl::OkStatus();
  const std::string first = Quoted(strangers[0]->path);
  if (may_be_meant || strangers.size() >= frames.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat(first, " does not belong to ", Describe(frames),
                     " beside it; move it away or choose the frames with a pattern such as "
                     "\"folder/name_*\""));
  }
  const size_t num_others = strangers.size() - 1;
  const std::string others = num_others == 0   ? ""
                             : num_others == 1 ? " and 1 other file"
                                               : absl::StrCat(" and ", num_others, " other files");
  notes->push_back(AboutTheSeries(
      "files_left_out", absl::StrCat(first, others,
                                     num_others == 0 ? " is left out: it does not belong to "
                                                     : " are left out: they do not belong to ",
                                     Describe(frames))));
  return absl::OkStatus();
}

absl::Status CheckDoubled(const std::vector<NameParts>& names) {
  for (size_t i = 1; i < names.size(); ++i) {
    if (!names[i].numbers.empty() && names[i].numbers == names[i - 1].numbers) {
      return absl::InvalidArgumentError(absl::StrCat(
          "frame number ", names[i].numbers.back(), " is there twice: ", Quoted(names[i - 1].path),
          " and ", Quoted(names[i].path), "; remove one"));
    }
  }
  return absl::OkStatus();
}

// The numbers of one series, ascending.
class Numbering {
 public:
  Numbering(const std::vector<NameParts>& names, size_t position) : names_(names) {
    for (const NameParts& name : names) numbers_.push_back(name.numbers[position]);
    for (size_t i = 1; i < numbers_.size(); ++i) steps_.push_back(numbers_[i] - numbers_[i - 1]);
  }

  std::vector<InputNote> Check() const {
    std::vector<InputNote> notes;
    if (numbers_[0] < 0) {
      notes.push_back(AboutTheSeries(
          "negative_numbers",
          absl::StrCat("the frame numbers begin below zero: ", Quoted(names_[0].path),
                       " is frame 0, ", Quoted(names_.back().path), " frame ", names_.size() - 1)));
    }
    // The step is the smallest distance; with two files only neighbors are a series.
    const int64_t step = steps_.size() == 1 ? 1 : *std::ranges::min_element(steps_);
    const bool is_even =
        std::ranges::all_of(steps_, [&](int64_t other) { return other % step == 0; });
    if (numbers_.back() >= kLeastTimeStamp) {
      AddTimeStamps(&notes);
    } else if (!is_even) {
      notes.push_back(AboutTheSeries(
          "uneven_numbers",
          absl::StrCat("the numbers in the file names are no frame numbers: ", names_.size(),
                       " frames are taken in their order, ", Quoted(names_[0].path), " to ",
                       Quoted(names_.back().path))));
    } else if (std::ranges::any_of(steps_, [&](int64_t other) { return other != step; }) ||
               (steps_.size() == 1 && steps_[0] != 1)) {
      notes.push_back(Gaps(step));
    }
    return notes;
  }

 private:
  InputNote Gaps(int64_t step) const {
    InputNote note{.severity = NoteSeverity::kWarning, .kind = "numbers_missing", .text = ""};
    int64_t num_missing = 0;
    int num_gaps = 0;
    std::string list;
    for (size_t i = 0; i < steps_.size(); ++i) {
      if (steps_[i] == step) continue;
      if (!note.frame) note.frame = static_cast<int>(i + 1);
      num_missing += steps_[i] / step - 1;
      if (++num_gaps > kMaxNamedGaps) continue;
      const int64_t first = numbers_[i] + step, last = numbers_[i + 1] - step;
      absl::StrAppend(&list, list.empty() ? "" : ", ", first);
      if (last > first) absl::StrAppend(&list, " to ", last);
    }
    const std::string place =
        absl::StrCat(" between ", Quoted(names_[static_cast<size_t>(*note.frame) - 1].path),
                     " and ", Quoted(names_[static_cast<size_t>(*note.frame)].path));
    note.text = absl::StrCat(
        num_missing == 1 ? "frame number " : "frame numbers ", list,
        num_gaps > kMaxNamedGaps ? absl::StrCat(", ... (", num_missing, " in all)") : "",
        num_missing == 1 ? " is" : " are", " missing", num_gaps > 1 ? ", the first" : "", place,
        ": the ", names_.size(),
        " files are taken one after the other; add what is missing, or "
        "renumber the files");
    return note;
  }

  // Time stamps never step evenly; a step that is far longer than the others is a frame that is
  // missing.
  void AddTimeStamps(std::vector<InputNote>* notes) const {
    notes->push_back(AboutTheSeries(
        "time_stamps", absl::StrCat("the numbers in the file names are time stamps: ",
                                    names_.size(), " frames are taken in their order, ",
                                    Quoted(names_[0].path), " to ", Quoted(names_.back().path))));
    std::vector<int64_t> sorted = steps_;
    std::ranges::sort(sorted);
    const int64_t median = sorted[sorted.size() / 2];
    const auto is_long = [&](int64_t step) { return 2 * step > 3 * median; };
    const auto first = std::ranges::find_if(steps_, is_long);
    if (first == steps_.end() || steps_.size() < 3) return;
    const auto at = static_cast<size_t>(first - steps_.begin());
    notes->push_back(
        {.severity = NoteSeverity::kWarning,
         .kind = "time_stamps_missing",
         .text = absl::StrCat(std::ranges::count_if(steps_, is_long),
                              " steps between time stamps are longer than the others, the first "
                              "between ",
                              Quoted(names_[at].path), " and ", Quoted(names_[at + 1].path),
                              ": frames may be missing there"),
         .frame = static_cast<int>(at + 1)});
  }

  const std::vector<NameParts>& names_;
  std::vector<int64_t> numbers_, steps_;
};

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  const int order = CompareNaturally(a, b);
  return order != 0 ? order < 0 : a < b;
}

absl::StatusOr<FrameFiles> SortFrameFiles(std::vector<std::string> paths) {
  std::sort(paths.begin(), paths.end(),
            [](const std::string& a, const std::string& b) { return NaturalLess(a, b); });
  const SeriesMap series = GroupByPattern(paths);
  const auto longest = std::max_element(
      series.begin(), series.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (longest == series.end() || longest->second.size() < 2) return FrameFiles{paths, {}};
  const std::vector<NameParts>& frames = longest->second;
  FrameFiles files;
  PLEAT_RETURN_IF_ERROR(LeaveOutStrangers(series, frames, &files.notes));
  PLEAT_RETURN_IF_ERROR(CheckDoubled(frames));
  for (const NameParts& frame : frames) files.paths.push_back(frame.path);
  if (const std::optional<size_t> position = CountingPosition(frames)) {
    for (InputNote& note : Numbering(frames, *position).Check()) {
      files.notes.push_back(std::move(note));
    }
  }
  return files;
}

}  // namespace pleat
