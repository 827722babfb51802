// TLS as a stranger's client sees it, and certificates that are replaced while the server runs.
#include "tls_version.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "pleat/base/file.h"
#include "server/handlers/mock_server.h"
#include "support/certificates.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

class TlsServerTest : public testing::Test {
 protected:
  TlsServerTest() { Write(Certificate::SignedBy(first_, "server")); }

  void Write(const Certificate& own) {
    EXPECT_THAT(WriteFile(files_.key, own.key_pem()), IsOk());
    EXPECT_THAT(WriteFile(files_.certificate, own.certificate_pem()), IsOk());
  }
  // Shakes hands in this version of TLS; the reason for which OpenSSL fails, or 0.
  static int Handshake(int port, int version) {
    const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(
        SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    // The server runs in this process, and what it forbids is forbidden here too.
    SSL_CTX_clear_options(context.get(), SSL_OP_NO_SSL_MASK);
    SSL_CTX_set_min_proto_version(context.get(), version);
    SSL_CTX_set_max_proto_version(context.get(), version);
    SSL_CTX_set_security_level(context.get(), 0);
    static const unsigned char kHttp2[] = {2, 'h', '2'};
    SSL_CTX_set_alpn_protos(context.get(), kHttp2, sizeof kHttp2);
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const std::unique_ptr<SSL, decltype(&SSL_free)> connection(SSL_new(context.get()), SSL_free);
    SSL_set_fd(connection.get(), fd);
    ERR_clear_error();
    const bool done = SSL_connect(connection.get()) == 1;
    const int reason = done ? 0 : ERR_GET_REASON(ERR_peek_error());
    ERR_clear_error();
    close(fd);
    return reason;
  }
  // Whether a client that trusts `authority` gets a connection.
  static bool Connects(int port, const Certificate& authority) {
    grpc::SslCredentialsOptions tls;
    tls.pem_root_certs = authority.certificate_pem();
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto channel = grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port),
                                                   grpc::SslCredentials(tls), arguments);
    return channel->WaitForConnected(std::chrono::system_clock::now() +
                                     std::chrono::milliseconds(300));
  }

  TemporaryFolder folder_;
  const TlsFiles files_{.certificate = folder_.path() + "/server.pem",
                        .key = folder_.path() + "/server.key",
                        .client_ca = {},
                        .reload_seconds = 1};
  const Certificate first_ = Certificate::Authority("first"),
                    second_ = Certificate::Authority("second");
};

TEST_F(TlsServerTest, OldVersionsAreRefusedByTheServer) {
  const MockServer server({.tls = files_});
  EXPECT_EQ(Handshake(server.server->port(), TLS1_3_VERSION), 0);
  // The server hangs up; gRPC sends no alert. A refusal by the client would have another reason.
  for (const int version : {TLS1_2_VERSION, TLS1_1_VERSION}) {
    EXPECT_EQ(Handshake(server.server->port(), version), SSL_R_UNEXPECTED_EOF_WHILE_READING);
  }
}

TEST_F(TlsServerTest, AReplacedCertificateIsUsedWithoutARestart) {
  const MockServer server({.tls = files_});
  EXPECT_TRUE(Connects(server.server->port(), first_));
  EXPECT_FALSE(Connects(server.server->port(), second_));
  Write(Certificate::SignedBy(second_, "server"));
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!Connects(server.server->port(), second_)) {
    ASSERT_LT(std::chrono::steady_clock::now(), patience) << "the old certificate is still used";
  }
}

TEST_F(TlsServerTest, TellsWhenItsCertificateExpires) {
  const MockServer server({.tls = files_});
  EXPECT_TRUE(server.server->certificate_expiry().has_value());
  ASSERT_THAT(WriteFile(files_.certificate, "no PEM"), IsOk());
  EXPECT_FALSE(server.server->certificate_expiry().has_value());
  EXPECT_FALSE(MockServer().server->certificate_expiry().has_value()) << "plain text";
}

}  // namespace
}  // namespace pleat
