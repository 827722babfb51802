#include "certificate_check.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <ctime>
#include <memory>

#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr uint64_t kMaxPemBytes = 1 << 20;

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

Bio Reader(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free);
}

Certificate ReadCertificate(const std::string& text) {
  return Certificate(PEM_read_bio_X509(Reader(text).get(), nullptr, nullptr, nullptr), X509_free);
}

absl::Status NoAuthority() {
  return absl::UnavailableError("the authority of client certificates is no PEM certificate");
}

absl::Status Check(const std::string& certificate, const std::string& key,
                   const std::string& client_ca) {
  const Certificate own = ReadCertificate(certificate);
  if (own == nullptr) return absl::UnavailableError("the TLS certificate is no PEM certificate");
  // No password is asked for: a server starts without a person.
  char no_password[] = "";
  const Key own_key(PEM_read_bio_PrivateKey(Reader(key).get(), nullptr, nullptr, no_password),
                    EVP_PKEY_free);
  if (own_key == nullptr) {
    return absl::UnavailableError("the TLS key is no PEM key, or it needs a password");
  }
  if (X509_check_private_key(own.get(), own_key.get()) != 1) {
    return absl::UnavailableError("the TLS certificate and the key do not fit together");
  }
  if (!client_ca.empty() && ReadCertificate(client_ca) == nullptr) {
    return NoAuthority();
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckCertificates(const std::string& certificate, const std::string& key,
                               const std::string& client_ca) {
  const absl::Status status = Check(certificate, key, client_ca);
  ERR_clear_error();  // what OpenSSL noted is said; the next user of this thread starts clean
  return status;
}

absl::Status CheckCertificateFiles(const std::string& certificate_path, const std::string& key_path,
                                   const std::string& client_ca_path) {
  PLEAT_ASSIGN_OR_RETURN(const std::string certificate, ReadFile(certificate_path, kMaxPemBytes));
  PLEAT_ASSIGN_OR_RETURN(const std::string key, ReadFile(key_path, kMaxPemBytes));
  std::string client_ca;
  if (!client_ca_path.empty()) {
    PLEAT_ASSIGN_OR_RETURN(client_ca, ReadFile(client_ca_path, kMaxPemBytes));
    if (client_ca.empty()) return NoAuthority();
  }
  return CheckCertificates(certificate, key, client_ca);
}

std::optional<int64_t> CertificateExpiry(const std::string& certificate) {
  const Certificate parsed = ReadCertificate(certificate);
  ERR_clear_error();
  std::tm time{};
  if (parsed == nullptr || ASN1_TIME_to_tm(X509_get0_notAfter(parsed.get()), &time) != 1) {
    return std::nullopt;
  }
  return timegm(&time);
}

std::optional<int64_t> CertificateFileExpiry(const std::string& certificate_path) {
  const absl::StatusOr<std::string> certificate = ReadFile(certificate_path, kMaxPemBytes);
  return certificate.ok() ? CertificateExpiry(*certificate) : std::nullopt;
}

}  // namespace pleat
