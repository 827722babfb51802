// gRPC 1.51 asks for TLS 1.2 at least and cannot be told otherwise: the version is in none of its
// public options. OpenSSL, however, applies the section `system_default` of its configuration to
// each context that anybody makes, and what that forbids stays forbidden.
#include "tls_version.h"

#include <openssl/bio.h>
#include <openssl/conf.h>
#include <openssl/crypto.h>
#include <openssl/err.h>

#include <memory>

namespace pleat {
namespace {

constexpr char kConfiguration[] =
    "openssl_conf = pleat\n"
    "[pleat]\nssl_conf = contexts\n"
    "[contexts]\nsystem_default = every_context\n"
    "[every_context]\nProtocol = -ALL, TLSv1.3\n";

bool Load() {
  // The configuration of the system comes first, lest it be loaded later and undo this.
  OPENSSL_init_crypto(OPENSSL_INIT_LOAD_CONFIG, nullptr);
  const std::unique_ptr<CONF, decltype(&NCONF_free)> configuration(NCONF_new(nullptr), NCONF_free);
  const std::unique_ptr<BIO, decltype(&BIO_free)> text(
      BIO_new_mem_buf(kConfiguration, sizeof kConfiguration - 1), BIO_free);
  long line = 0;
  return configuration != nullptr && text != nullptr &&
         NCONF_load_bio(configuration.get(), text.get(), &line) > 0 &&
         CONF_modules_load(configuration.get(), nullptr, 0) > 0;
}

}  // namespace

absl::Status RequireTls13() {
  static const bool loaded = Load();
  ERR_clear_error();
  if (loaded) return absl::OkStatus();
  return absl::UnavailableError("OpenSSL cannot be told to refuse versions of TLS before 1.3");
}

}  // namespace pleat
