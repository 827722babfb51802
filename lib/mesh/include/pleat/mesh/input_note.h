// What a reader noticed about an input that it could read all the same.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pleat {

enum class NoteSeverity {
  kNote,     // something was left out or decided; the motion is what the files say
  kWarning,  // the result may not be what the user meant
};

struct InputNote {
  NoteSeverity severity = NoteSeverity::kNote;
  std::string kind{};  // of a fixed list, for programs ("faces_left_out"); one note for each kind
  std::string text{};  // for people: what, where, why and what to do
  std::optional<int> frame{};        // the first frame that it is about
  bool refused_when_strict = false;  // as every warning is
};

// The notes of one input and the names of its frames.
struct InputReport {
  std::vector<InputNote> notes{};
  std::vector<std::string> frame_names{};  // file names, UTF-8; empty when frames have none
  bool has_frame_rate = false;             // the input says how many frames a second has
  std::optional<double> first_frame{};     // its number on the timeline that the input was made on
};

// "frame 2 (f_3.obj)", or "frame 2" where frames have no names.
std::string FrameLabel(const std::vector<std::string>& frame_names, int frame);

// "frames 2 (f_3.obj), 4 to 7 and 9": runs are joined, and of many runs the first few are named,
// with the count of all. frames: ascending, not empty.
std::string FrameListLabel(const std::vector<std::string>& frame_names,
                           const std::vector<int>& frames);

// Collects the notes of the frames of one sequence: each kind is said once, in the words of the
// first frame that has it and with the number of frames.
class FrameNotes {
 public:
  // The notes of frame `frame`; frames come in ascending order.
  void Add(int frame, const std::vector<InputNote>& notes);

  // One note for each kind. The text begins with the place of the first: the frame, or `input` when
  // the sequence is that file alone.
  std::vector<InputNote> Merge(const std::vector<std::string>& frame_names,
                               std::string_view input) const;

 private:
  struct Kind {
    InputNote first;
    std::vector<int> frames;
  };
  std::vector<Kind> kinds_;
};

// "note" or "warning".
const char* SeverityName(NoteSeverity severity);

bool IsRefusedWhenStrict(const InputNote& note);

}  // namespace pleat
