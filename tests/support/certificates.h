// Certificates for tests of encrypted connections, made on the spot.
#pragma once

#include <openssl/evp.h>
#include <openssl/x509.h>

#include <memory>
#include <string>

namespace pleat {

// A key with its certificate; signs others when it is an authority.
class Certificate {
 public:
  // Signs itself.
  static Certificate Authority(const std::string& name);
  // For a server on 127.0.0.1 or a client.
  static Certificate SignedBy(const Certificate& authority, const std::string& name);

  std::string certificate_pem() const;
  std::string key_pem() const;

 private:
  using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
  using X509Pointer = std::unique_ptr<X509, decltype(&X509_free)>;

  Certificate(const std::string& name, bool is_authority, const Certificate* authority);

  Key key_;
  X509Pointer x509_;
};

}  // namespace pleat
