#include "file_name.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace pleat {

void OfferAs(const RequestTarget& target, HttpResponse* response) {
  const auto save = target.query.find("save");
  if (save == target.query.end() || save->second.empty()) return;
  std::string escaped;
  for (const char c : save->second) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte) || c == '.' || c == '-' || c == '_') {
      escaped.push_back(c);
    } else {
      absl::StrAppendFormat(&escaped, "%%%02X", byte);
    }
  }
  response->headers.emplace_back("Content-Disposition",
                                 absl::StrCat("attachment; filename*=UTF-8''", escaped));
}

}  // namespace pleat
