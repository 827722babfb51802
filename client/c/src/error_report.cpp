#include "error_report.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

namespace pleat {
namespace {

// The length of the longest prefix of at most `max_size` bytes that cuts no UTF-8 character.
size_t PrefixOfWholeCharacters(absl::string_view text, size_t max_size) {
  if (text.size() <= max_size) return text.size();
  size_t size = max_size;
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) --size;
  return size;
}

pleat_code Fill(pleat_code code, absl::string_view message, pleat_error* error) noexcept {
  if (error == nullptr) return code;
  const size_t size = PrefixOfWholeCharacters(message, sizeof(error->message) - 1);
  error->code = code;
  if (size > 0) std::memcpy(error->message, message.data(), size);  // no words: no address
  error->message[size] = '\0';
  return code;
}

}  // namespace

pleat_code Report(const absl::Status& status, pleat_error* error) noexcept {
  return Fill(static_cast<pleat_code>(status.code()), status.message(), error);
}

pleat_code ReportException(pleat_error* error) noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return Fill(PLEAT_RESOURCE_EXHAUSTED, "no memory is left for this call", error);
  } catch (const std::length_error&) {
    return Fill(PLEAT_RESOURCE_EXHAUSTED, "a list would be longer than memory", error);
  } catch (const std::exception& exception) {
    return Fill(PLEAT_INTERNAL, exception.what(), error);
  } catch (...) {
    return Fill(PLEAT_INTERNAL, "an unknown exception", error);
  }
}

absl::Status CheckStructSize(absl::string_view name, size_t struct_size, size_t first_size) {
  if (struct_size >= first_size) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(name, ".struct_size is ", struct_size,
                                                 "; set it to sizeof(", name,
                                                 "), which is at least ", first_size));
}

}  // namespace pleat
