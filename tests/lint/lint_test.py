"""Tests of structure.py: for every rule a planted breach that it must find, and a clean twin that must pass."""

import contextlib
import io
import pathlib
import subprocess
import tempfile
import unittest

import functions
import known
import rules
import structure
from tree import Tree, code_of, comment_of, include_of

GUARD = "#pragma once\n"


def include(header):
    return f'#include "{header}"\n'


def module(*extra):
    """A module lib/gp with everything that a module needs, but for `extra`."""
    files = {"lib/gp/CMakeLists.txt": "", "lib/gp/README.md": "# gp\n", "tests/gp/kernel_test.cpp": ""}
    return {path: text for path, text in files.items() if path not in extra}


def function(num_lines):
    return "int Add(int a) {\n" + "  ++a;\n" * (num_lines - 2) + "}\n"


# Rule -> (files that break it, the same files without the breach).
PLANTED = {
    "protobuf": ({"lib/local/src/a.cpp": include("pleat/v1/model.pb.h")},
                 {"lib/wire/src/a.cpp": include("pleat/v1/model.pb.h")}),
    "store-schema": ({"lib/store/src/a.cpp": include("pleat/v1/model.pb.h")},
                     {"lib/store/src/a.cpp": include("pleat/store/v1/record.pb.h")}),
    "draco": ({"lib/sequence_codec/src/a.cpp": include("draco/mesh/mesh.h")},
              {"lib/stream/src/a.cpp": include("draco/mesh/mesh.h")}),
    "grpc": ({"client/cli/io/a.cpp": "#include <grpcpp/channel.h>\n"},
             {"client/remote/src/a.cpp": "#include <grpcpp/channel.h>\n"}),
    "spdlog": ({"client/cli/main.cpp": "#include <spdlog/spdlog.h>\n"},
               {"server/main.cpp": "#include <spdlog/spdlog.h>\n"}),
    "sqlite": ({"lib/local/src/a.cpp": "#include <sqlite3.h>\n"}, {"lib/store/src/a.cpp": "#include <sqlite3.h>\n"}),
    "processor": ({"lib/gp/src/a.cpp": 'bool b = __builtin_cpu_supports("avx2");\n'},
                  {"lib/simd/src/a.cpp": 'bool b = __builtin_cpu_supports("avx2");\n'}),
    "target": ({"lib/skinning/src/a.cpp": '__attribute__((target("avx2"))) void Skin();\n'},
               {"lib/skinning/src/a.cpp": 'PLEAT_TARGET_AVX512("avx512f") void Skin();\n'}),
    "gp-sees-matrices": ({"lib/gp/src/a.cpp": include("pleat/mesh/topology.h")},
                         {"lib/gp/src/a.cpp": include("pleat/optimize/scg.h")}),
    "learner-sees-matrices": ({"lib/learner/src/a.cpp": include("pleat/skeleton/pose.h")},
                              {"lib/learner/src/a.cpp": include("pleat/gp/kernel.h")}),
    "handlers-have-no-meshes": ({"server/handlers/src/a.cpp": include("Eigen/Core")},
                                {"server/handlers/src/a.cpp": include("pleat/wire/messages.h")}),
    "contract": ({"client/cli/verbs/verb_train.cpp": include("pleat/local/local_character_service.h")},
                 {"client/cli/service.cpp": include("pleat/local/local_character_service.h")}),
    "client-sees-no-server": ({"client/cli/a.cpp": include("pleat/grpc/grpc_server.h")},
                              {"server/main.cpp": include("pleat/grpc/grpc_server.h")}),
    "server-sees-no-client": ({"server/main.cpp": include("pleat/remote/remote_character_service.h")},
                              {"client/cli/a.cpp": include("pleat/remote/remote_character_service.h")}),
    "server-decodes-no-draco": ({"server/handlers/src/a.cpp": include("pleat/stream/draco_file.h")},
                                {"client/draco_child/main.cpp": include("pleat/stream/draco_file.h")}),
    "c-interface": ({"client/c/pleat.h": GUARD + "#include <string>\n"},
                    {"client/c/pleat.h": GUARD + "#include <stdint.h>\n"}),
    "prints": ({"lib/gp/src/a.cpp": "std::cerr << 1;\n"}, {"client/cli/main.cpp": "std::cerr << 1;\n"}),
    "exits": ({"lib/gp/src/a.cpp": "std::exit(1);\n"}, {"lib/gp/src/a.cpp": "Exits(1);\n"}),
    "environment": ({"lib/gp/src/a.cpp": 'std::getenv("HOME");\n'}, {"client/a.cpp": 'std::getenv("HOME");\n'}),
    "clock": ({"lib/gp/src/a.cpp": "auto t = std::chrono::steady_clock::now();\n"},
              {"lib/gp/src/a.cpp": "void Push(std::chrono::steady_clock::time_point now);\n"}),
    "randomness": ({"lib/gp/src/a.cpp": "std::mt19937 random;\n"}, {"tests/gp/a_test.cpp": "std::mt19937 random;\n"}),
    "fast-math": ({"lib/gp/CMakeLists.txt": "add_compile_options(-ffast-math)\n"},
                  {"lib/gp/CMakeLists.txt": "# no -ffast-math\nadd_compile_options(-ffp-contract=off)\n"}),
    "reactor-ownership": ({"server/handlers/src/a.cpp": "class A : public grpc::ServerUnaryReactor {};\n"},
                          {"server/handlers/src/a.cpp": "class A : public CallReactor<grpc::ServerUnaryReactor> {};\n"}),
    "dynamic-cast": ({"client/cli/verbs/a.cpp": "dynamic_cast<Remote*>(service);\n"},
                     {"tests/stream/a_test.cpp": "dynamic_cast<Remote*>(service);\n"}),
    "errno": ({"lib/store/src/a.cpp": 'return absl::ErrnoToStatus(errno, "cannot sync");\n'},
              {"lib/store/src/a.cpp": 'return ErrnoStatus(errno, "cannot sync");\n'}),
    "sleep": ({"tests/jobs/a_test.cpp": "std::this_thread::sleep_for(seconds(1));\n"},
              {"tests/jobs/a_test.cpp": "// no sleep_for here\nnotification.WaitForNotification();\n"}),
    "unfinished": ({"lib/gp/src/a.cpp": "// TO" "DO: later\n"}, {"lib/gp/src/a.cpp": "// Later frames first.\n"}),
    "spelling": ({"lib/render/src/a.cpp": "Rgb line_colour;\n"}, {"lib/render/src/a.cpp": "Rgb line_color;\n"}),
    "file-length": ({"tests/run.sh": "true\n" * 401}, {"tests/run.sh": "true\n" * 400}),
    "function-length": ({"lib/gp/src/a.cpp": function(61)}, {"lib/gp/src/a.cpp": function(60)}),
    "pragma-once": ({"lib/gp/a.h": "// no #pragma once\n"}, {"lib/gp/a.h": "// A guard.\n" + GUARD}),
    "markdown-width": ({"docs/a.md": "| " + "wide " * 24 + "|\n"},
                       {"docs/a.md": "```\n" + "wide " * 30 + f"\n```\n- [a](docs/{'a' * 120}.md)\n"}),
    "module-readme": (module("lib/gp/README.md"), module()),
    "module-tests": (module("tests/gp/kernel_test.cpp"), module()),
    "test-share": ({"lib/gp/src/scg.cpp": "", "tests/gp/scgs_test.cpp": ""},
                   {"lib/gp/src/scg.cpp": "", "tests/gp/scg_test.cpp": ""}),
}


@contextlib.contextmanager
def planted(files):
    """The root of a temporary tree with these files."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        yield pathlib.Path(folder)


def rules_broken(files):
    with planted(files) as root:
        return {breach.rule for breach in structure.check(Tree(root))}


def run_main(root, *options):
    """(exit code, printed lines) of the tool."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = structure.main([str(root), *options])
    return code, printed.getvalue().splitlines()


class RuleTest(unittest.TestCase):

    def test_every_rule_has_a_planted_breach(self):
        self.assertEqual(set(PLANTED), structure.rule_names())

    def test_every_rule_finds_its_breach_and_passes_the_clean_twin(self):
        for rule, (breach, clean) in PLANTED.items():
            with self.subTest(rule=rule):
                self.assertIn(rule, rules_broken(breach))
                self.assertNotIn(rule, rules_broken(clean))

    def test_a_program_other_than_the_named_files_may_not_make_the_local_service(self):
        for path in ("server/grpc/src/server.cpp", "server/handlers/src/a.cpp", "client/cli/io/a.cpp"):
            self.assertIn("contract", rules_broken({path: include("pleat/jobs/job_manager.h")}))

    def test_jobs_and_the_local_service_know_no_rpc(self):
        for room in ("jobs", "local", "service", "character"):
            broken = rules_broken({f"lib/{room}/src/a.cpp": include("pleat/v1/job_service.grpc.pb.h")})
            self.assertLessEqual({"grpc", "protobuf"}, broken)

    def test_each_excused_file_is_excused_only_while_it_needs_it(self):
        for rule in rules.RULES:
            for path, reason in rule.files:
                with self.subTest(rule=rule.name, path=path):
                    self.assertGreater(len(reason), 10)
                    breach = "".join(PLANTED[rule.name][0].values())
                    self.assertNotIn(rule.name, rules_broken({path: breach}))
                    self.assertIn(rule.name, rules_broken({path: "int a;\n"}))

    def test_british_words_are_found_in_identifiers_and_american_ones_pass(self):
        for word in ("NormaliseRows", "num_neighbours", "kMillimetres", "Analysed", "quantisation", "modelling"):
            self.assertIn("spelling", rules_broken({"lib/a.cpp": word}), word)
        for word in ("NormalizeRows", "analyses", "precise", "promised", "kCancelled", "parameters", "optimistic"):
            self.assertNotIn("spelling", rules_broken({"lib/a.cpp": word}), word)


class ViewTest(unittest.TestCase):

    def test_code_has_no_comments_and_no_literals(self):
        self.assertEqual(code_of('Call("a // b", 1\'000); // exit(1)').rstrip(), 'Call("", 1\'000);')

    def test_comments_do_not_begin_inside_literals(self):
        self.assertEqual(comment_of('Call("http://a"); // why').strip(), "why")
        self.assertEqual(comment_of('Call("http://a");'), "")

    def test_includes_have_either_bracket(self):
        self.assertEqual(include_of("#  include <a/b.h>  // why"), "a/b.h")
        self.assertEqual(include_of('// #include "a.h"'), "")


class FunctionTest(unittest.TestCase):

    def lengths(self, text):
        return [(f.name, f.num_lines) for f in functions.functions_of(text)]

    def test_functions_in_namespaces_and_classes_are_found(self):
        text = "namespace a {\nclass B : public C {\n public:\n  int d() const { return d_; }\n};\nint E(F f) {\n}\n}\n"
        self.assertEqual(self.lengths(text), [("d", 1), ("E", 2)])

    def test_member_initializers_with_braces_belong_to_the_head(self):
        self.assertEqual(self.lengths("A::A(int b) : b_{b}, c_{1} {\n  d();\n}\n"), [("A::A", 3)])
        self.assertEqual(self.lengths("int F(const Limits& limits = {}) {\n  d();\n}\n"), [("F", 3)])

    def test_braces_in_literals_comments_and_macros_do_not_count(self):
        text = '#define A {\\\n  {\nint F() {\n  // }\n  return G("}", \'}\', R"(})");\n}\n'
        self.assertEqual(self.lengths(text), [("F", 4)])

    def test_lambdas_and_initializers_count_with_their_function(self):
        self.assertEqual(self.lengths("int F() {\n  auto g = [](int a) {\n    return a;\n  };\n}\n"), [("F", 5)])
        self.assertEqual(self.lengths("const Table kTable = {F(1), {G(2)}};\nenum class A { kB };\n"), [])


class KnownBreachesTest(unittest.TestCase):

    TWO = {"lib/render/src/a.cpp": "int colour;\nint centre;\n"}
    LIST = "tests/lint/known_breaches.txt"

    def test_known_breaches_pass(self):
        with planted(self.TWO | {self.LIST: "spelling lib/render/src/a.cpp 2  # for now\n"
                                            "test-share lib 1\n"}) as root:
            self.assertEqual(run_main(root), (0, []))

    def test_one_breach_more_fails(self):
        with planted(self.TWO | {self.LIST: "spelling lib/render/src/a.cpp 1\ntest-share lib 1\n"}) as root:
            code, printed = run_main(root)
            self.assertEqual((code, len(printed)), (1, 3))
            self.assertIn("a.cpp:2: American spelling", printed[1])
            self.assertEqual(run_main(root, "--update")[0], 1)

    def test_a_repaired_breach_fails_until_the_list_is_updated(self):
        known_lines = "path docs/a.md 4\nspelling lib/render/src/a.cpp 3  # for now\ntest-share lib 1\n"
        with planted(self.TWO | {self.LIST: known_lines}) as root:
            code, printed = run_main(root)
            self.assertEqual((code, len(printed)), (1, 1))
            self.assertIn("--update", printed[0])
            self.assertEqual(run_main(root, "--update"), (0, []))
            self.assertEqual((root / self.LIST).read_text(), known.HEADER + known_lines.replace(" 3 ", " 2 "))
            self.assertEqual(run_main(root), (0, []))

    def test_a_moved_file_takes_its_breaches_along(self):
        with planted(self.TWO | {self.LIST: "spelling lib/draw/src/a.cpp 2\ntest-share lib 1\n"}) as root:
            self.assertEqual(run_main(root)[0], 1)
            self.assertEqual(run_main(root, "--update")[0], 0)
            self.assertIn("spelling lib/render/src/a.cpp 2\n", (root / self.LIST).read_text())


class TreeTest(unittest.TestCase):

    def test_in_a_checkout_only_tracked_files_count(self):
        with planted({"lib/a.h": "", "build/b.h": ""}) as root:
            subprocess.run(["git", "init", "--quiet", str(root)], check=True)
            subprocess.run(["git", "-C", str(root), "add", "lib"], check=True)
            self.assertEqual(Tree(root).paths, ["lib/a.h"])

    def test_elsewhere_all_files_count_and_folders_exist(self):
        with planted({"lib/a.h": "", "b/c/d.h": ""}) as root:
            tree = Tree(root)
            self.assertEqual(tree.paths, ["b/c/d.h", "lib/a.h"])
            self.assertTrue(tree.exists("b/c/"))
            self.assertFalse(tree.exists("b/d.h"))


if __name__ == "__main__":
    unittest.main()
