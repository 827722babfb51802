// The name under which a browser saves a response.
#pragma once

#include "pleat/http/http_message.h"
#include "request_target.h"

namespace pleat {

// Adds Content-Disposition with the query "save"; nothing when there is none. Characters that are
// no plain ones of a name are sent escaped (RFC 8187).
void OfferAs(const RequestTarget& target, HttpResponse* response);

}  // namespace pleat
