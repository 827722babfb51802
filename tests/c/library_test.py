"""Checks what a shared library shows to its host: the symbols that it exports, what it needs, its size.

usage: library_test.py LIBRARY [--evaluates-only]
"""

import argparse
import pathlib
import re
import subprocess
import tempfile

MAX_STRIPPED_BYTES = 3_000_000
# Functions of the C library that hand out memory which malloc made: freed by ours, it would go to the
# allocator of the host (client/c/src/allocator.cpp).
GIVES_MEMORY = {"strdup", "strndup", "getline", "getdelim", "realpath", "asprintf", "vasprintf", "getcwd", "scandir"}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def declared_functions():
    """The functions of the C headers."""
    folder = pathlib.Path(__file__).parents[2] / "client/c"
    return {name for header in folder.glob("*.h")
            for name in re.findall(r"PLEAT_API [^;(]*?(pleat_\w+)\(", header.read_text())}


def check_symbols(library, evaluates_only):
    exported = [line.split() for line in run("nm", "-D", "--defined-only", library).splitlines()]
    names = {fields[-1] for fields in exported if fields[1] != "A"}
    strange = {name for name in names if not re.fullmatch(r"pleat_\w+@@PLEAT_\d+", name)}
    assert not strange, f"exported beside pleat_*: {sorted(strange)[:10]}"
    functions = {name.split("@")[0] for name in names}
    declared = declared_functions()
    assert functions <= declared, f"exported and in no header: {functions - declared}"
    if not evaluates_only:
        assert functions == declared, f"in a header and not exported: {declared - functions}"
    wanted = {line.split()[-1].split("@")[0] for line in run("nm", "-D", "--undefined-only", library).splitlines()}
    assert not wanted & GIVES_MEMORY, f"frees what the C library made: {wanted & GIVES_MEMORY}"
    return len(functions)


def check_needed(library):
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", library))
    heavy = [name for name in needed if re.search(r"grpc|gpr|protobuf|draco|sqlite|prometheus|spdlog", name)]
    assert not heavy, f"the library that only evaluates links {heavy}"
    return needed


def check_size(library):
    with tempfile.TemporaryDirectory() as folder:
        stripped = pathlib.Path(folder) / "stripped.so"
        run("strip", "-o", str(stripped), library)
        size = stripped.stat().st_size
    assert size < MAX_STRIPPED_BYTES, f"{size} bytes stripped; {MAX_STRIPPED_BYTES} are the most"
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("library")
    parser.add_argument("--evaluates-only", action="store_true")
    options = parser.parse_args()
    print(check_symbols(options.library, options.evaluates_only), "functions")
    if options.evaluates_only:
        print("needs", *check_needed(options.library))
        print(check_size(options.library), "bytes stripped")


if __name__ == "__main__":
    main()
