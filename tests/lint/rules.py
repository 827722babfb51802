"""The rules that a single line can break. Each row says what is refused, where, and why.

`lint_test.py` plants a breach of every row; a row without one fails that test.
"""

import dataclasses
import re

from tree import CPP, code_of, include_of


@dataclasses.dataclass(frozen=True)
class Breach:
    rule: str
    path: str
    line: int
    message: str

    def __str__(self):
        return f"{self.path}:{self.line}: {self.message} [{self.rule}]"


@dataclasses.dataclass(frozen=True)
class Rule:
    name: str
    why: str
    view: str  # what of a line the pattern sees: "include", "code" (no comments, no literals) or "text"
    pattern: str
    where: tuple[str, ...] = ("",)  # prefixes of the paths that the rule is about
    rooms: tuple[str, ...] = ()  # prefixes of the paths in which the pattern is at home
    files: tuple[tuple[str, str], ...] = ()  # single files that may break the rule, each with its reason
    suffixes: tuple[str, ...] = CPP


PROTOBUF = r"\.pb\.h$|^google/protobuf/"
RPC_ROOMS = ("server/reactors/", "server/handlers/", "server/grpc/")
PROGRAMS = ("lib/", "server/", "client/")

# British spellings, also inside identifiers; the file `catalogue.db` of existing stores keeps its name. `cancelled` is
# left out because Abseil and gRPC spell it so.
BRITISH = (
    r"catalogue(?!\.db)"
    r"|colour|centre|neighbour|behaviour|favour|honour|licence|defence|artefact|grey|metre|fibre|learnt"
    r"|analys(?:e[dr]?(?-i:(?![a-z]))|ing)|catalys(?:ed?(?-i:(?![a-z]))|ing)"
    r"|(?:label|model|travel|signal|channel)l(?:ed|ing)"
    r"|(?:custom|discret|factor|general|initial|linear|maxim|minim|normal|optim|organ|parallel|parametr|quant|real"
    r"|recogn|regular|serial|special|stabil|standard|summar|symmetr|synchron|token|util|vector|visual)"
    r"is(?:e[drs]?(?-i:(?![a-z]))|ing|ation|able)"
)

RULES = (
    # Who may see which package.
    Rule("protobuf", "Protocol Buffers stay in lib/wire, lib/store and the RPC layers", "include", PROTOBUF,
         rooms=("lib/wire/", "lib/store/", *RPC_ROOMS, "server/observe/", "server/http/", "client/remote/", "tests/")),
    Rule("store-schema", "what is stored has its own schema: lib/store includes pleat/store/v1 only", "include",
         r"^(?!pleat/store/v1/).*\.pb\.h$", where=("lib/store/",)),
    Rule("draco", "Draco stays in lib/stream", "include", r"^draco/", rooms=("lib/stream/", "tests/")),
    Rule("grpc", "gRPC stays in server/{reactors,handlers,grpc} and client/remote", "include",
         r"^grpc(?:pp|\+\+)?/|\.grpc\.pb\.h$", rooms=(*RPC_ROOMS, "client/remote/", "tests/")),
    Rule("spdlog", "only the server logs", "include", r"^spdlog/", rooms=("server/", "tests/server/")),
    Rule("sqlite", "SQLite stays in lib/store", "include", r"^sqlite3(?:ext)?\.h$", rooms=("lib/store/",)),
    # Who asks the processor.
    Rule("processor", "lib/simd alone asks the processor what it can do", "code",
         r"__builtin_cpu_(?:supports|is|init)|__get_cpuid|\bgetauxval\b", rooms=("lib/simd/",)),
    Rule("target", "functions for newer processors are marked with the macros of lib/simd", "code",
         r"__attribute__\s*\(\(.*\btarget\s*\(|\[\[gnu::target\b|#\s*pragma.*\btarget\b", rooms=("lib/simd/",)),
    # Which rooms may see which.
    Rule("gp-sees-matrices", "lib/gp sees matrices only: base, math, simd, optimize", "include",
         r"^pleat/(?!(?:base|math|simd|optimize|gp)/)", where=("lib/gp/",)),
    Rule("learner-sees-matrices", "lib/learner sees matrices only: base, math, simd, optimize, gp", "include",
         r"^pleat/(?!(?:base|math|simd|optimize|gp|learner)/)", where=("lib/learner/",)),
    Rule("handlers-have-no-meshes", "a handler converts and calls; arithmetic on meshes belongs in lib/", "include",
         r"^Eigen/|^pleat/(?:geometry|rigging|fitting|learner|gp)/", where=("server/handlers/",)),
    Rule("contract", "server/ and client/ know pleat/service; only main, --local and `store`, which works on data folders, know what is below",
         "include", r"^pleat/(?:local|store|jobs|cache)/", where=("server/", "client/"),
         rooms=("server/main.cpp", "server/options.", "server/service_gauges.", "client/cli/service.cpp",
                "client/cli/verbs/verb_store.cpp")),
    Rule("client-sees-no-server", "the client knows pleat/service and the wire, never the server's rooms", "include",
         r"^pleat/(?:reactors|handlers|grpc|observe)/", where=("client/",)),
    Rule("server-sees-no-client", "the server never knows the client's rooms", "include", r"^pleat/(?:remote|client)/",
         where=("server/",)),
    Rule("server-decodes-no-draco", "the server decodes no Draco; client/draco_child does, with limits", "include",
         r"^pleat/stream/draco_file\.h$", where=("server/", "lib/local/", "lib/jobs/", "lib/store/")),
    Rule("c-interface", "the headers of the C interface are C, and include nothing but each other", "include",
         r"^(?!std(?:def|int)\.h$|pleat(?:_session|_server)?\.h$).",
         where=("client/c/pleat.h", "client/c/pleat_server.h", "client/c/pleat_session.h")),
    # What library code does not do.
    Rule("prints", "library code never prints", "code",
         r"\bstd::(?:cout|cerr|clog)\b|\b(?:printf|puts|fprintf|perror)\s*\(", where=("lib/",)),
    Rule("exits", "library code never exits", "code", r"\b(?:exit|abort|quick_exit|terminate)\s*\(", where=("lib/",)),
    Rule("environment", "library code never reads the environment", "code", r"\b(?:secure_)?getenv\s*\(",
         where=("lib/",)),
    Rule("clock", "library code never reads the clock: it takes a clock as an argument", "code",
         r"\b\w*[cC]lock::now\b|\babsl::Now\b|\bclock_gettime\b|\bgettimeofday\b|\btime\s*\((?:nullptr|NULL|0|&)",
         where=("lib/",),
         files=(("lib/base/src/processor_time.cpp", "it counts what threads use; no result depends on it"),
                ("lib/base/src/wall_clock.cpp", "the default of the wall clocks that others take as an argument"),
                ("lib/store/src/quarantine.cpp", "it writes down for an operator when a file came"),
                ("lib/jobs/src/job_state_machine.cpp", "the default of the clock that jobs take as an argument"),
                ("lib/service/src/compression.cpp", "it reports how long coding took; no bytes depend on it"),
                ("lib/local/src/local_pose_stream.cpp", "it reports how long a pose waited; no frame depends on it"),
                ("lib/local/src/pose_batcher.cpp", "it reports how long a batch took; results never depend on it"),
                ("lib/local/src/pose_session.cpp", "it reports how long a frame took; results never depend on it"))),
    Rule("randomness", "the same seed gives the same model everywhere: library code draws its own random numbers",
         "code",
         r"\bstd::(?:random_device|mt19937\w*|default_random_engine|\w+_distribution|shuffle|rand)\b|\brand\s*\(",
         where=("lib/",),
         files=(("lib/base/src/random_id.cpp", "ids of jobs and stores must differ; no result depends on them"),)),
    Rule("fast-math", "the same bytes give the same model: no fast-math, no contraction", "text",
         r"^[^#]*-(?:ffast-math|Ofast|funsafe-math|fassociative-math|ffp-contract=(?:fast|on))",
         suffixes=("CMakeLists.txt", ".cmake", "CMakePresets.json")),
    Rule("reactor-ownership", "a reactor is a CallReactor, made by StartReactor: call_reactor.h says who owns it", "code",
         r"\bdelete\s+this\b|\bnew\s+\w*(?:Reactor|Stream)\b|\bpublic\s+grpc::Server\w+Reactor\b",
         where=("server/",)),
    Rule("dynamic-cast", "a cast to the concrete type breaks the contract of the interface", "code",
         r"\bdynamic_cast\b", where=PROGRAMS),
    Rule("errno", "ErrnoStatus of pleat/base/status.h has a code for every errno; Abseil calls rare ones UNKNOWN", "code",
         r"\bErrnoToStatus(?:Code)?\s*\(", where=PROGRAMS,
         files=(("lib/base/src/status.cpp", "it is what ErrnoStatus begins with"),)),
    # Tests and words.
    Rule("sleep", "a test waits for what happens, never for time", "code",
         r"\b(?:sleep_for|sleep_until|usleep|nanosleep)\b|\babsl::SleepFor\b", where=("tests/",)),
    Rule("unfinished", "unfinished work belongs in an issue", "text", r"\b(?:TODO|FIXME|XXX)\b",
         suffixes=CPP + (".proto", ".sh", ".md", "CMakeLists.txt", ".cmake")),
    Rule("spelling", "American spelling, please", "text", rf"(?i){BRITISH}", suffixes=CPP + (".md", ".proto")),
)

_VIEWS = {"include": include_of, "code": code_of, "text": lambda line: line}


def check_lines(tree, rules=RULES):
    """Every breach of the rules above, and every excused file that no longer needs its excuse."""
    for rule in rules:
        pattern, view, excused = re.compile(rule.pattern), _VIEWS[rule.view], dict(rule.files)
        for path in tree.select(rule.suffixes, rule.where):
            if rule.rooms and path.startswith(rule.rooms):
                continue
            hits = [n for n, line in enumerate(tree.lines(path), 1) if pattern.search(view(line))]
            if path not in excused:
                yield from (Breach(rule.name, path, number, rule.why) for number in hits)
            elif not hits:
                yield Breach(rule.name, path, 1, "needs no exception any more: take it out of rules.py")
