// numpy.lib.format, versions 1.0 to 3.0: "\x93NUMPY", two bytes of version, the length of the
// header (uint16, from version 2.0 on uint32), and the header: a Python dictionary with the keys
// descr, fortran_order and shape.
#include "npy_header.h"

#include <charconv>
#include <cstring>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr std::string_view kNpyMagic("\x93NUMPY", 6);
constexpr size_t kMaxHeaderBytes = 65536;
constexpr size_t kMaxDimensions = 32;

absl::Status HeaderFault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the header of the array ", what));
}

// Reads the dictionary, in the forms that Python's repr() gives it.
class DictionaryParser {
 public:
  explicit DictionaryParser(std::string_view text) : text_(text) {}

  absl::StatusOr<NpyArray> Parse() {
    if (!Take('{')) return HeaderFault("is no dictionary");
    while (!Take('}')) {
      PLEAT_ASSIGN_OR_RETURN(const std::string key, ReadText());
      if (!Take(':')) return HeaderFault("lacks a ':'");
      PLEAT_RETURN_IF_ERROR(ReadValue(key));
      if (!Take(',') && Peek() != '}') return HeaderFault("lacks a ','");
    }
    for (const char* key : {"descr", "fortran_order", "shape"}) {
      if (keys_.count(key) == 0) return HeaderFault(absl::StrCat("lacks '", key, "'"));
    }
    return array_;
  }

 private:
  char Peek() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n')) text_.remove_prefix(1);
    return text_.empty() ? '\0' : text_[0];
  }
  bool Take(char wanted) {
    if (Peek() != wanted) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool TakeWord(std::string_view word) {
    Peek();
    if (!text_.starts_with(word)) return false;
    text_.remove_prefix(word.size());
    return true;
  }

  absl::StatusOr<std::string> ReadText() {
    TakeWord("u");  // Python 2 wrote u'descr'
    const char quote = Peek();
    if (quote != '\'' && quote != '"') return HeaderFault("lacks a text in quotes");
    const size_t end = text_.find(quote, 1);
    if (end == std::string_view::npos) return HeaderFault("ends inside a text");
    std::string text(text_.substr(1, end - 1));
    text_.remove_prefix(end + 1);
    return text;
  }

  absl::Status ReadValue(const std::string& key) {
    keys_.insert(key);
    if (key == "shape") return ReadShape();
    if (key == "fortran_order") {
      array_.is_fortran = TakeWord("True");
      if (array_.is_fortran || TakeWord("False")) return absl::OkStatus();
      return HeaderFault("says neither True nor False for 'fortran_order'");
    }
    if (key != "descr") return HeaderFault(absl::StrCat("has the unknown key '", key, "'"));
    if (Peek() == '[') {
      return absl::InvalidArgumentError(
          "its elements are records of several fields, which are not read: save each field alone");
    }
    PLEAT_ASSIGN_OR_RETURN(const std::string descr, ReadText());
    return ReadType(descr);
  }

  absl::Status ReadShape() {
    if (!Take('(')) return HeaderFault("has no tuple for 'shape'");
    array_.shape.clear();
    while (!Take(')')) {
      int64_t size = -1;
      Peek();
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), size);
      if (error != std::errc() || size < 0) return HeaderFault("has no size in 'shape'");
      text_.remove_prefix(static_cast<size_t>(end - text_.data()));
      TakeWord("L");  // Python 2 wrote 3L
      array_.shape.push_back(size);
      if (array_.shape.size() > kMaxDimensions) return HeaderFault("has too many dimensions");
      if (!Take(',') && Peek() != ')') return HeaderFault("lacks a ',' in 'shape'");
    }
    return absl::OkStatus();
  }

  // "<f4": the order of bytes, the kind, the size.
  absl::Status ReadType(const std::string& descr) {
    const std::string named = absl::StrCat("'", EscapeControls(descr), "'");
    if (descr.size() < 2) return HeaderFault(absl::StrCat("has the unknown type ", named));
    size_t size = 0;
    const auto [end, error] = std::from_chars(descr.data() + 2, descr.data() + descr.size(), size);
    array_.kind = descr[1];
    if (array_.kind == 'O') {
      return absl::InvalidArgumentError(
          "its elements are Python objects, which would have to run to be read: save numbers");
    }
    const bool is_text = array_.kind == 'U' || array_.kind == 'S';
    const bool is_known = is_text || std::strchr("fiub", array_.kind) != nullptr;
    const bool is_size = is_text || size == 1 || size == 2 || size == 4 || size == 8;
    if (error != std::errc() || end != descr.data() + descr.size() || !is_known || !is_size ||
        size > kMaxHeaderBytes || (array_.kind == 'f' && size < 2) ||
        (array_.kind == 'b' && size != 1) || std::strchr("<>|=", descr[0]) == nullptr) {
      return absl::InvalidArgumentError(
          absl::StrCat("its elements are of the type ", named,
                       ", which is not read: save float32 or float64, and integers for faces"));
    }
    array_.is_big_endian = descr[0] == '>';
    array_.item_bytes = array_.kind == 'U' ? 4 * size : size;
    return absl::OkStatus();
  }

  std::string_view text_;
  NpyArray array_;
  std::set<std::string> keys_;
};

}  // namespace

absl::StatusOr<NpyArray> ParseNpyHeader(std::string_view bytes, size_t* num_bytes) {
  if (!bytes.starts_with(kNpyMagic)) {
    return absl::InvalidArgumentError("not an array of NumPy: it does not begin with \\x93NUMPY");
  }
  if (bytes.size() < 12) return absl::DataLossError("the array ends inside its header");
  const auto version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3) {
    return absl::InvalidArgumentError(
        absl::StrCat("version ", version, " of NumPy's format; 1 to 3 are known"));
  }
  uint32_t size = 0;
  const size_t size_bytes = version == 1 ? 2 : 4, begin = 8 + size_bytes;
  std::memcpy(&size, bytes.data() + 8, size_bytes);
  if (size > kMaxHeaderBytes || size > bytes.size() - begin) {
    return absl::DataLossError(
        absl::StrCat("the array declares a header of ", size, " bytes, which is not there"));
  }
  *num_bytes = begin + size;
  return DictionaryParser(bytes.substr(begin, size)).Parse();
}

}  // namespace pleat
