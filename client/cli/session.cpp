#include "cli/session.h"

#include <chrono>

namespace pleat {

std::string Session::ServerAddress() const {
  if (!server.empty()) return server;
  if (!environment_server.empty()) return environment_server;
  return kDefaultServer;
}

std::string Session::DataFolder() const {
  if (!data_dir.empty()) return data_dir;
  if (!environment_data.empty()) return environment_data;
  return environment_home.empty() ? "pleat-data" : environment_home + "/.local/share/pleat";
}

double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace pleat
