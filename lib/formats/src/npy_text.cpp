// Text in NumPy's arrays: fixed numbers of UCS-4 characters (kind U) or bytes (kind S), padded with
// zeros.
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "npy_array.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr uint32_t kReplacementCode = 0xfffd, kLargestCode = 0x10ffff;

void AppendUtf8(uint32_t code, std::string* text) {
  if (code > kLargestCode || (code >= 0xd800 && code < 0xe000)) code = kReplacementCode;
  const auto tail = [&](int shift) {
    text->push_back(static_cast<char>(0x80 | (code >> shift & 0x3f)));
  };
  if (code < 0x80) {
    text->push_back(static_cast<char>(code));
  } else if (code < 0x800) {
    text->push_back(static_cast<char>(0xc0 | code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    text->push_back(static_cast<char>(0xe0 | code >> 12));
    tail(6);
    tail(0);
  } else {
    text->push_back(static_cast<char>(0xf0 | code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::vector<uint32_t> CodesOf(std::string_view name) {
  std::vector<uint32_t> codes;
  for (const char c : NameToUtf8(name)) {
    const auto byte = static_cast<uint8_t>(c);
    if (byte < 0x80) {
      codes.push_back(byte);
    } else if (byte >= 0xc0) {
      codes.push_back(byte & (byte >= 0xf0 ? 0x07 : byte >= 0xe0 ? 0x0f : 0x1f));
    } else {
      codes.back() = codes.back() << 6 | (byte & 0x3f);
    }
  }
  return codes;
}

}  // namespace

std::vector<std::string> NpyTexts(const NpyArray& array) {
  std::vector<std::string> texts;
  for (int64_t i = 0; i < array.num_items(); ++i) {
    const std::string_view item =
        array.data.substr(static_cast<size_t>(i) * array.item_bytes, array.item_bytes);
    if (array.kind == 'S') {
      texts.push_back(NameToUtf8(item.substr(0, item.find('\0'))));
      continue;
    }
    std::string text;
    for (size_t c = 0; c + 4 <= item.size(); c += 4) {
      uint32_t code;
      std::memcpy(&code, item.data() + c, 4);
      if (array.is_big_endian) code = __builtin_bswap32(code);
      if (code == 0) break;
      AppendUtf8(code, &text);
    }
    texts.push_back(std::move(text));
  }
  return texts;
}

std::string EncodeNpyTexts(const std::vector<std::string>& texts) {
  std::vector<std::vector<uint32_t>> codes;
  size_t longest = 1;
  for (const std::string& text : texts) {
    codes.push_back(CodesOf(text));
    longest = std::max(longest, codes.back().size());
  }
  std::string bytes = NpyHeader(absl::StrCat("<U", longest), {static_cast<int64_t>(texts.size())});
  for (std::vector<uint32_t>& text : codes) {
    text.resize(longest, 0);
    bytes.append(reinterpret_cast<const char*>(text.data()), 4 * longest);
  }
  return bytes;
}

}  // namespace pleat
