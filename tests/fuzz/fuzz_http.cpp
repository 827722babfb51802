// What the studio parses itself: targets of requests, names of files, the origin of a request, and
// JSON of calls. The first byte says which.
#include <cstddef>
#include <cstdint>
#include <string>

#include "file_name.h"
#include "json_calls.h"
#include "request_guard.h"
#include "request_target.h"

namespace {

using namespace pleat;  // NOLINT(google-build-using-namespace)

void TakeTarget(const std::string& text) {
  const auto target = ParseTarget(text);
  if (!target.ok()) return;
  HttpResponse response;
  OfferAs(*target, &response);
  for (const auto& [name, value] : response.headers) {
    // Nothing may end the header.
    if (value.find_first_of("\r\n") != std::string::npos) __builtin_trap();
  }
}

void TakePath(const std::string& text) {
  const auto path = CheckRelativePath(text);
  if (!path.ok()) return;
  if (path->empty() || path->front() == '/' ||
      ("/" + *path + "/").find("/../") != std::string::npos) {
    __builtin_trap();
  }
}

void TakeOrigin(const std::string& text) {
  HttpRequest request;
  request.headers = {{"host", "127.0.0.1:7321"}, {"origin", text}, {kCallMarker, "1"}};
  const auto hosts = HostsOf("127.0.0.1:7321", {});
  // The longest origin of ours is "https://127.0.0.1:7321".
  if (CheckRequest(request, RequestKind::kCall, hosts).ok() && text.size() > 22) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  switch (data[0] % 4) {
    case 0:
      TakeTarget(text);
      break;
    case 1:
      TakePath(text);
      break;
    case 2:
      TakeOrigin(text);
      break;
    default:
      RequestFromJson(**FindMethod("JobService", "CreateTrainingJob"), text).IgnoreError();
  }
  return 0;
}
