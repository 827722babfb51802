#include "trace_context.h"

#include <algorithm>

namespace pleat {
namespace {

// Lower-case hexadecimal digits that are not all zero.
bool IsId(std::string_view text) {
  return std::ranges::all_of(
             text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }) &&
         text.find_first_not_of('0') != std::string_view::npos;
}

}  // namespace

std::string TraceIdOf(std::string_view traceparent) {
  constexpr size_t kSize = 55;  // "00-" 32 digits "-" 16 digits "-" 2 digits
  if (traceparent.size() != kSize || traceparent.substr(0, 3) != "00-" || traceparent[35] != '-' ||
      traceparent[52] != '-') {
    return "";
  }
  const std::string_view trace = traceparent.substr(3, 32), parent = traceparent.substr(36, 16);
  return IsId(trace) && IsId(parent) ? std::string(trace) : "";
}

}  // namespace pleat
