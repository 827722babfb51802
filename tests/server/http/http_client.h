// A client that sends bytes as they are, for tests of what a server makes of them.
#pragma once

#include <sys/socket.h>

#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/grpc/sockets.h"

namespace pleat {

class HttpClient {
 public:
  // address: "127.0.0.1:PORT".
  explicit HttpClient(const std::string& address)
      : address_(address), client_(std::stoi(address.substr(address.rfind(':') + 1))) {}

  void Send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(client_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      bytes.remove_prefix(static_cast<size_t>(sent));
    }
  }
  // Everything until the server closes the connection.
  std::string ReadAll() {
    std::string bytes;
    while (ReadSome(&bytes)) {
    }
    return bytes;
  }
  // Until `words` have come; all that came.
  std::string ReadUntil(std::string_view words) {
    std::string bytes;
    while (bytes.find(words) == std::string::npos && ReadSome(&bytes)) {
    }
    return bytes;
  }
  // One request on a connection that ends with it. headers: "name: value" without line ends.
  static std::string Ask(const std::string& address, const std::string& method,
                         const std::string& target, const std::vector<std::string>& headers = {},
                         const std::string& body = "") {
    HttpClient client(address);
    std::string head = absl::StrCat(method, " ", target, " HTTP/1.1\r\nConnection: close\r\n");
    bool has_host = false;
    for (const std::string& header : headers) {
      has_host = has_host || header.starts_with("Host:");
      absl::StrAppend(&head, header, "\r\n");
    }
    if (!has_host) absl::StrAppend(&head, "Host: ", address, "\r\n");
    if (!body.empty() || method != "GET")
      absl::StrAppend(&head, "Content-Length: ", body.size(), "\r\n");
    client.Send(head + "\r\n" + body);
    return client.ReadAll();
  }
  static int StatusOf(const std::string& response) {
    return response.size() > 12 ? std::stoi(response.substr(9, 3)) : 0;
  }
  static std::string BodyOf(const std::string& response) {
    const size_t end = response.find("\r\n\r\n");
    return end == std::string::npos ? "" : response.substr(end + 4);
  }

 private:
  bool ReadSome(std::string* bytes) {
    char buffer[16384];
    const ssize_t count = recv(client_.fd(), buffer, sizeof buffer, 0);
    if (count > 0) bytes->append(buffer, static_cast<size_t>(count));
    return count > 0;
  }

  const std::string address_;
  TcpClient client_;
};

}  // namespace pleat
