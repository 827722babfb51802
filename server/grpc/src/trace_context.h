// The trace that a call belongs to (W3C Trace Context, "traceparent").
#pragma once

#include <string>
#include <string_view>

namespace pleat {

// The 32 digits of the trace id of a `traceparent` header, empty when it is not what the standard
// says (version "00": 00-TRACE-PARENT-FLAGS) or when its ids are zero.
std::string TraceIdOf(std::string_view traceparent);

}  // namespace pleat
