// Whether PEM texts are what TLS needs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"

namespace pleat {

// OK when `certificate` begins with a certificate, `key` is a private key, and they belong
// together. client_ca: empty, or it begins with a certificate. kUnavailable says what is wrong.
absl::Status CheckCertificates(const std::string& certificate, const std::string& key,
                               const std::string& client_ca);

// The same of files; a client_ca without a path is none. The errors of reading them as well.
absl::Status CheckCertificateFiles(const std::string& certificate_path, const std::string& key_path,
                                   const std::string& client_ca_path);

// The Unix second at which the first certificate of a PEM text expires; nothing when there is none.
std::optional<int64_t> CertificateExpiry(const std::string& certificate);
std::optional<int64_t> CertificateFileExpiry(const std::string& certificate_path);

}  // namespace pleat
