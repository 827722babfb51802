#include "pleat/mesh/input_note.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr size_t kMaxNamedRuns = 4;

}  // namespace

std::string FrameLabel(const std::vector<std::string>& frame_names, int frame) {
  if (static_cast<size_t>(frame) >= frame_names.size()) return absl::StrCat("frame ", frame);
  return absl::StrCat("frame ", frame, " (", frame_names[static_cast<size_t>(frame)], ")");
}

std::string FrameListLabel(const std::vector<std::string>& frame_names,
                           const std::vector<int>& frames) {
  if (frames.size() == 1) return FrameLabel(frame_names, frames[0]);
  std::string text;
  size_t num_runs = 0;
  for (size_t begin = 0, end = 0; begin < frames.size(); begin = end) {
    end = begin + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
    if (++num_runs > kMaxNamedRuns) {
      return absl::StrCat(frames.size(), " frames: ", text.substr(6), ", ...");
    }
    absl::StrAppend(&text, text.empty() ? "" : ", ",
                    FrameLabel(frame_names, frames[begin]).substr(text.empty() ? 0 : 6));
    if (end > begin + 1) absl::StrAppend(&text, " to ", frames[end - 1]);
  }
  return "frames" + text.substr(5);
}

void FrameNotes::Add(int frame, const std::vector<InputNote>& notes) {
  for (const InputNote& note : notes) {
    auto kind = std::ranges::find_if(
        kinds_, [&](const Kind& known) { return known.first.kind == note.kind; });
    if (kind == kinds_.end()) kind = kinds_.insert(kinds_.end(), {note, {}});
    kind->frames.push_back(frame);
  }
}

std::vector<InputNote> FrameNotes::Merge(const std::vector<std::string>& frame_names,
                                         std::string_view input) const {
  std::vector<InputNote> merged;
  for (const Kind& kind : kinds_) {
    InputNote note = kind.first;
    note.frame = kind.frames[0];
    const bool is_series = frame_names.size() > 1;
    const std::string place =
        is_series ? FrameLabel(frame_names, kind.frames[0]) : std::string(input);
    note.text = absl::StrCat(place, ": ", note.text);
    if (is_series && kind.frames.size() == frame_names.size()) {
      absl::StrAppend(&note.text, "; alike in all ", kind.frames.size(), " frames");
    } else if (is_series && kind.frames.size() > 1) {
      absl::StrAppend(&note.text, "; alike in ", kind.frames.size(), " of ", frame_names.size(),
                      " frames");
    }
    merged.push_back(std::move(note));
  }
  return merged;
}

const char* SeverityName(NoteSeverity severity) {
  return severity == NoteSeverity::kWarning ? "warning" : "note";
}

bool IsRefusedWhenStrict(const InputNote& note) {
  return note.severity == NoteSeverity::kWarning || note.refused_when_strict;
}

}  // namespace pleat
