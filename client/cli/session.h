// What every verb shares: where it prints, where it runs, and what the parser chose to run.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

struct Session {
  std::ostream* out = nullptr;     // results
  std::ostream* err = nullptr;     // progress and errors
  bool err_is_terminal = false;    // progress is a bar instead of lines
  std::string environment_server;  // PLEAT_SERVER, empty when unset
  std::string environment_data;    // PLEAT_DATA, empty when unset
  std::string environment_home;    // HOME, empty when unset
  std::string environment_token;   // PLEAT_TOKEN, empty when unset

  // The flags that verbs share.
  std::string server;    // --server
  std::string data_dir;  // --data-dir
  bool local = false;
  bool tls = false;             // --tls, or one of the files below
  std::string tls_ca;           // --tls-ca: a PEM file, empty = the authorities of the system
  std::string tls_certificate;  // --tls-cert and --tls-key: PEM files of the client
  std::string tls_key;
  std::string token_file;  // --token-file: holds the token; empty = PLEAT_TOKEN
  bool json = false;
  bool quiet = false;
  bool force = false;                 // existing files may be replaced
  bool strict = false;                // warnings are errors
  std::string animation;              // --animation: of glTF inputs, empty = the first that moves
  std::string object;                 // --object: of Alembic inputs, empty = all meshes that move
  std::vector<std::string> npz_keys;  // --key: "ROLE=NAME", the arrays of .npz inputs

  // The callback of the chosen verb in the parser sets these two.
  std::string verb;
  std::function<absl::Status()> run;

  // Returns the address that remote verbs talk to.
  std::string ServerAddress() const;
  // Returns the folder of the local store.
  std::string DataFolder() const;
  // Says whether progress is printed at all.
  bool talkative() const { return !quiet && !json; }
};

inline constexpr char kDefaultServer[] = "127.0.0.1:7320";

// Returns the seconds of a monotonic clock, for durations.
double MonotonicSeconds();

}  // namespace pleat
