#include "support/certificates.h"

#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

namespace pleat {
namespace {

constexpr long kHour = 3600;

void AddExtension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value);
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

// What `write` puts into memory.
template <typename Write>
std::string Pem(const Write& write) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> memory(BIO_new(BIO_s_mem()), BIO_free);
  write(memory.get());
  const char* text = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &text);
  return {text, static_cast<size_t>(size)};
}

}  // namespace

Certificate::Certificate(const std::string& name, bool is_authority, const Certificate* authority)
    : key_(EVP_EC_gen("P-256"), EVP_PKEY_free), x509_(X509_new(), X509_free) {
  X509* x509 = x509_.get();
  X509* issuer = authority == nullptr ? x509 : authority->x509_.get();
  X509_set_version(x509, 2);  // version 3
  ASN1_INTEGER_set(X509_get_serialNumber(x509), authority == nullptr ? 1 : 2);
  X509_gmtime_adj(X509_getm_notBefore(x509), -kHour);
  X509_gmtime_adj(X509_getm_notAfter(x509), kHour);
  X509_NAME_add_entry_by_txt(X509_get_subject_name(x509), "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0);
  X509_set_issuer_name(x509, X509_get_subject_name(issuer));
  X509_set_pubkey(x509, key_.get());
  AddExtension(x509, issuer, NID_basic_constraints, is_authority ? "critical,CA:TRUE" : "CA:FALSE");
  if (!is_authority) AddExtension(x509, issuer, NID_subject_alt_name, "IP:127.0.0.1");
  X509_sign(x509, authority == nullptr ? key_.get() : authority->key_.get(), EVP_sha256());
}

Certificate Certificate::Authority(const std::string& name) {
  return Certificate(name, true, nullptr);
}

Certificate Certificate::SignedBy(const Certificate& authority, const std::string& name) {
  return Certificate(name, false, &authority);
}

std::string Certificate::certificate_pem() const {
  return Pem([&](BIO* memory) { PEM_write_bio_X509(memory, x509_.get()); });
}

std::string Certificate::key_pem() const {
  return Pem([&](BIO* memory) {
    PEM_write_bio_PrivateKey(memory, key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
}

}  // namespace pleat
