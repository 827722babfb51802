#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/verbs/verbs.h"

namespace pleat {

CLI::App* AddVerb(CLI::App& app, Session& session, const std::string& name,
                  const std::string& description, std::function<absl::Status()> run) {
  CLI::App* verb = app.add_subcommand(name, description);
  verb->add_flag("--json", session.json, "print the result as JSON on stdout, nothing else");
  verb->add_flag("--quiet,-q", session.quiet, "no progress on stderr; results and warnings stay");
  verb->add_flag(
      "--strict", session.strict,
      "end with exit code 5 where there would be a warning, or a doubt about which files "
      "are meant");
  verb->callback([&session, name, run = std::move(run)] {
    session.verb = name;
    session.run = run;
  });
  return verb;
}

absl::Status RefuseWarningsWhenStrict(const Session& session, size_t num_warnings) {
  if (!session.strict || num_warnings == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("the result has ", num_warnings,
                                                    num_warnings == 1 ? " warning" : " warnings",
                                                    " (refused because of --strict)"));
}

void AddObjectFlag(CLI::App* verb, Session& session) {
  verb->add_option("--object", session.object,
                   "PATH of the mesh to read from an .abc, or of an object with meshes below it "
                   "[all meshes that move]");
  verb->add_option("--animation", session.animation,
                   "NAME or number of the animation to read from a .glb or .gltf [the first]");
  verb->add_option("--key", session.npz_keys,
                   "ROLE=NAME: an array of an .npz (positions, faces, face_sizes, frame_rate)");
}

void AddServerFlags(CLI::App* verb, Session& session) {
  CLI::Option* server = verb->add_option("--server", session.server,
                                         "address of pleatd [PLEAT_SERVER, else 127.0.0.1:7320]");
  CLI::Option* local =
      verb->add_flag("--local", session.local, "run in this process, without a server");
  server->excludes(local);
  verb->add_flag("--tls", session.tls, "encrypted connection")->excludes(local);
  verb->add_option("--tls-ca", session.tls_ca, "PEM file of the authority to trust [the system's]")
      ->excludes(local);
  CLI::Option* certificate =
      verb->add_option("--tls-cert", session.tls_certificate, "PEM file: this client's certificate")
          ->excludes(local);
  CLI::Option* key = verb->add_option("--tls-key", session.tls_key, "PEM file: its private key")
                         ->needs(certificate);
  certificate->needs(key);
  verb->add_option("--token-file", session.token_file,
                   "file with the token for the server [the text in PLEAT_TOKEN]")
      ->excludes(local);
  verb->add_option("--data-dir", session.data_dir,
                   "with --local: folder of sequences, jobs and models "
                   "[PLEAT_DATA, else ~/.local/share/pleat]")
      ->needs(local);
}

void AddOptionalServerFlags(CLI::App* verb, Session& session) {
  AddServerFlags(verb, session);
  verb->get_option("--server")
      ->description("address of pleatd: compute there instead of in this process");
  verb->get_option("--data-dir")
      ->description("with --local: go through the store in this folder, as a server would");
}

bool RunsOnService(const Session& session) {
  return !session.server.empty() || !session.data_dir.empty();
}

void AddTtlFlag(CLI::App* verb, const std::string& what, double* ttl_hours) {
  verb->add_option("--ttl-hours", *ttl_hours,
                   absl::StrCat("hours that the service keeps ", what, " at least; 0 = for ever"))
      ->check(CLI::Range(0., 876'000.))
      ->capture_default_str();
}

absl::Duration TtlOf(double ttl_hours) {
  return ttl_hours == 0 ? absl::InfiniteDuration() : absl::Hours(ttl_hours);
}

void AddForceFlag(CLI::App* verb, Session& session) {
  verb->add_flag("--force", session.force, "replace files that exist");
}

void AddInProcessFlag(CLI::App* verb, Session& session) {
  verb->add_flag("--local", session.local, "accepted: this verb always runs in this process");
}

}  // namespace pleat
