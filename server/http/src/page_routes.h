// The files of the page and the rules that a browser keeps for it.
#pragma once

#include <string>

#include "pleat/http/http_message.h"

namespace pleat {

// A file of the page, or kNotFound. Pages of browsers all understand gzip; others get the bytes
// unpacked.
HttpResponse AnswerPage(const std::string& path, const HttpRequest& request);

// Adds what every response says to a browser: nothing but the page's own files runs, nobody else
// frames or reads it (Content-Security-Policy and its relatives).
void AddSafetyHeaders(HttpResponse* response);

}  // namespace pleat
