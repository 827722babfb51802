#include "page_routes.h"

#include <zlib.h>

#include <utility>

#include "absl/strings/match.h"
#include "pleat/http/page_files.h"

namespace pleat {
namespace {

// WebAssembly (Draco) needs a word of its own. Object URLs are pictures and files that the page
// itself has made.
constexpr char kPolicy[] =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src "
    "'self'; "
    "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

constexpr size_t kMaxUnpackedBytes = size_t{64} << 20;

std::string Unpack(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) return {};
  std::string unpacked(kMaxUnpackedBytes, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(unpacked.data());
  stream.avail_out = static_cast<uInt>(unpacked.size());
  const int result = inflate(&stream, Z_FINISH);
  unpacked.resize(result == Z_STREAM_END ? stream.total_out : 0);
  inflateEnd(&stream);
  return unpacked;
}

}  // namespace

HttpResponse AnswerPage(const std::string& path, const HttpRequest& request) {
  for (const PageFile& file : PageFiles()) {
    if (file.path != (path == "/" ? "/index.html" : path)) continue;
    HttpResponse response{.headers = {{"Content-Type", std::string(file.content_type)},
                                      {"ETag", std::string(file.tag)},
                                      {"Cache-Control", "no-cache"}}};
    if (request.Header("if-none-match") == file.tag) {
      response.status = 304;
      return response;
    }
    if (absl::StrContains(request.Header("accept-encoding"), "gzip")) {
      response.headers.emplace_back("Content-Encoding", "gzip");
      response.lasting_body = file.bytes;
    } else {
      response.body = Unpack(file.bytes);
    }
    return response;
  }
  return ErrorResponse(absl::NotFoundError("there is nothing at this address"));
}

void AddSafetyHeaders(HttpResponse* response) {
  static constexpr std::pair<const char*, const char*> kHeaders[] = {
      {"Content-Security-Policy", kPolicy},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Embedder-Policy", "require-corp"},
      {"Permissions-Policy", "camera=(), microphone=(), geolocation=()"}};
  for (const auto& [name, value] : kHeaders) response->headers.emplace_back(name, value);
}

}  // namespace pleat
