// Whether PEM texts are what TLS needs.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace pleat {

// OK when `certificate` begins with a certificate, `key` is a private key, and they belong
// together. client_ca: empty, or it begins with a certificate. kUnavailable says what is wrong.
absl::Status CheckCertificates(const std::string& certificate, const std::string& key,
                               const std::string& client_ca);

}  // namespace pleat
