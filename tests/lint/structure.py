"""Checks the invariants of ARCHITECTURE.md that text can show. Prints each breach and fails.

usage: structure.py [ROOT] [--update] [--report]
  --update  writes the counts of tests/lint/known_breaches.txt down, never up
  --report  prints the share of sources with a test of the same name, and checks nothing
"""

import argparse
import pathlib
import re
import sys

import functions
import known
from rules import RULES, Breach, check_lines
from tree import CODE, CPP, Tree

MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 60
MAX_MARKDOWN_COLUMNS = 120
PROGRAM_FOLDERS = ("lib", "server", "client")
# The least share of sources that have a test of the same name.
MIN_SHARE = {"lib": 0.80, "server": 0.85, "client": 0.85}


def check_length(tree):
    for path in tree.select(CODE):
        count = len(tree.lines(path))
        if count > MAX_FILE_LINES:
            yield Breach("file-length", path, 1, f"{count} lines; {MAX_FILE_LINES} are the most: is it one thing?")


def check_functions(tree):
    for path in tree.select(CPP, [f"{folder}/" for folder in PROGRAM_FOLDERS]):
        for function in functions.functions_of(tree.text(path)):
            if function.num_lines > MAX_FUNCTION_LINES:
                yield Breach("function-length", path, function.line,
                             f"{function.name} has {function.num_lines} lines; {MAX_FUNCTION_LINES} are the most")


def check_guards(tree):
    for path in tree.select([".h"]):
        if not re.search(r"^#pragma once$", tree.text(path), re.MULTILINE):
            yield Breach("pragma-once", path, 1, "a header needs #pragma once")


def check_markdown(tree):
    """Lines of Markdown fit into the columns, tables too; a fence and a line that cannot be broken may not."""
    for path in tree.select([".md"]):
        in_fence = False
        for number, line in enumerate(tree.lines(path), 1):
            if line.lstrip().startswith("```"):
                in_fence = not in_fence
            elif len(line) > MAX_MARKDOWN_COLUMNS and not in_fence and not _is_unbreakable(line):
                yield Breach("markdown-width", path, number,
                             f"{len(line)} columns; {MAX_MARKDOWN_COLUMNS} are the most")


def _is_unbreakable(line):
    """True for one link or address, perhaps behind the mark of a list item."""
    body = re.sub(r"^\s*(?:[-*+>]|\d+\.)?\s*", "", line)
    return bool(re.fullmatch(r"!?\[[^\]]*\]\([^)]*\)[.,;]?|\[[^\]]*\]:\s*\S+|\S+", body))


def check_modules(tree):
    """Each module of lib/ says in a README what it is, and has tests."""
    for build in tree.select(["/CMakeLists.txt"], ["lib/"]):
        module = pathlib.PurePosixPath(build).parent
        if len(module.parts) != 2:
            continue
        if not tree.exists(f"{module}/README.md"):
            yield Breach("module-readme", str(module), 1, "a module needs a README.md")
        if not tree.select(["_test.cpp"], [f"tests/{module.name}/"]):
            yield Breach("module-tests", str(module), 1, f"a module needs tests/{module.name}/*_test.cpp")


def test_shares(tree):
    """{folder: (sources with a test of the same name, sources)}; main.cpp is tested as a program."""
    tests = {pathlib.PurePosixPath(path).stem for path in tree.select(["_test.cpp", "_test.py"], ["tests/"])}
    shares = {}
    for folder in PROGRAM_FOLDERS:
        stems = {pathlib.PurePosixPath(path).stem for path in tree.select([".cpp"], [f"{folder}/"])} - {"main"}
        shares[folder] = (sum(f"{stem}_test" in tests for stem in stems), len(stems))
    return shares


def check_shares(tree):
    for folder, (tested, sources) in test_shares(tree).items():
        if sources and tested / sources < MIN_SHARE[folder]:
            yield Breach("test-share", folder, 1, f"{tested} of {sources} sources have a test of the same name; "
                                                  f"{MIN_SHARE[folder]:.0%} is the least")


# Every check beyond the table of lines, by the rules that it can report.
CHECKS = {
    ("file-length",): check_length,
    ("function-length",): check_functions,
    ("pragma-once",): check_guards,
    ("markdown-width",): check_markdown,
    ("module-readme", "module-tests"): check_modules,
    ("test-share",): check_shares,
}


def rule_names():
    return {rule.name for rule in RULES} | {name for names in CHECKS for name in names}


def check(tree):
    found = list(check_lines(tree))
    for run in CHECKS.values():
        found += run(tree)
    return found


def report(tree):
    for folder, (tested, sources) in test_shares(tree).items():
        share = tested / sources if sources else 0
        print(f"{folder}: {tested} of {sources} sources have a test of the same name, {share:.0%}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", default=pathlib.Path(__file__).parents[2])
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--report", action="store_true")
    options = parser.parse_args(arguments)
    tree = Tree(options.root)
    if options.report:
        report(tree)
        return 0
    return known.settle(tree.root, check(tree), rule_names(), options.update)


if __name__ == "__main__":
    sys.exit(main())
