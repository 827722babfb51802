"""Checks the invariants of ARCHITECTURE.md that text can show; prints each breach and fails."""

import pathlib
import re
import subprocess
import sys

MAX_FILE_LINES = 400

# (who alone may include it, pattern, why)
INCLUDE_RULES = [
    (("lib/wire/", "server/handlers/", "client/", "tests/", "server/observe/", "server/src/", "server/main.cpp"),
     r'#include [<"].*\.pb\.h', "protobuf types stay in lib/wire and the RPC layers"),
    (("lib/codec/", "tests/"), r'#include [<"]draco/', "Draco lives in lib/codec"),
    (("server/", "client/", "tests/"), r"#include [<\"]grpc", "gRPC lives in server/ and client/"),
    (("server/", "client/", "tests/"), r"#include [<\"]spdlog", "logging lives in the programs"),
]
LIBRARY_RULES = [
    (r"\bstd::(cout|cerr|clog)\b|\b(printf|puts|fprintf)\s*\(", "library code never prints"),
    (r"\b(std::)?(exit|abort|quick_exit)\s*\(", "library code never exits"),
    (r"\bgetenv\s*\(|\bstd::chrono::\w+_clock|\btime\s*\(nullptr\)",
     "library code never reads the clock or the environment"),
]


def tracked(*patterns):
    listing = subprocess.run(["git", "ls-files", *patterns], capture_output=True, text=True, check=True)
    return [pathlib.Path(line) for line in listing.stdout.splitlines()]


def breaches(path):
    text = path.read_text()
    lines = text.splitlines()
    name = path.as_posix()
    if len(lines) > MAX_FILE_LINES:
        yield 1, f"{len(lines)} lines; a file has at most {MAX_FILE_LINES}: does it hold one thing?"
    if path.suffix == ".h" and "#pragma once" not in text:
        yield 1, "a header needs #pragma once"
    for number, line in enumerate(lines, 1):
        code = line.split("//")[0]
        for owners, pattern, why in INCLUDE_RULES:
            if re.search(pattern, code) and not name.startswith(owners):
                yield number, why
        if name.startswith("lib/"):
            for pattern, why in LIBRARY_RULES:
                if re.search(pattern, code):
                    yield number, why
        if re.search(r"\b(TODO|FIXME|XXX)\b", line):
            yield number, "unfinished work belongs in an issue"


def missing_tests():
    """Every module has tests; a folder with a README says what it is."""
    for module in sorted(pathlib.Path("lib").iterdir()):
        if not module.is_dir():
            continue
        if not list(pathlib.Path("tests", module.name).glob("*_test.cpp")):
            yield f"{module}: no tests/{module.name}/*_test.cpp"
        if not (module / "README.md").exists():
            yield f"{module}: no README.md"


def main():
    found = []
    for path in tracked("*.h", "*.cpp"):
        found += [f"{path}:{number}: {why}" for number, why in breaches(path)]
    found += list(missing_tests())
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
