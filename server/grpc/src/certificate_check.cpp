#include "certificate_check.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

namespace pleat {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

Bio Reader(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free);
}

Certificate ReadCertificate(const std::string& text) {
  return Certificate(PEM_read_bio_X509(Reader(text).get(), nullptr, nullptr, nullptr), X509_free);
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
    return absl::UnavailableError("the authority of client certificates is no PEM certificate");
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

}  // namespace pleat
