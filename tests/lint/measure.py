"""Prints the measurements of the tree: sizes, tests, comments, cycles of modules, long functions.

usage: measure.py [ROOT]
"""

import argparse
import pathlib
import re
import statistics
import sys

import functions
from structure import MAX_FUNCTION_LINES, PROGRAM_FOLDERS, test_shares
from tree import CPP, Tree, include_of


def modules_of(tree):
    """Folders that export include/pleat/NAME/: {NAME: folder}. NAME is what an include names."""
    found = {}
    for path in tree.select([".h"], [f"{folder}/" for folder in PROGRAM_FOLDERS]):
        match = re.match(r"(.+)/include/pleat/(\w+)/", path)
        if match:
            found[match[2]] = match[1]
    return found


def include_graph(tree, modules):
    """{NAME: names of the modules that its files include}."""
    graph = {}
    for name, folder in modules.items():
        seen = set()
        for path in tree.select(CPP, [f"{folder}/"]):
            for line in tree.lines(path):
                match = re.match(r"pleat/(\w+)/", include_of(line))
                if match and match[1] in modules:
                    seen.add(match[1])
        graph[name] = seen - {name}
    return graph


def cycles(graph):
    """The groups of modules that reach each other; empty when the order of includes has no way back."""
    reach = {name: _reachable(graph, name) for name in graph}
    groups = {frozenset({b for b in reach[a] if a in reach[b]} | {a}) for a in graph if a in reach[a]}
    return sorted(sorted(group) for group in groups)


def _reachable(graph, start):
    seen, todo = set(), list(graph[start])
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo += graph[name]
    return seen


def count_lines(tree, paths):
    return sum(len(tree.lines(path)) for path in paths)


def whole_line_comments(tree, paths):
    """The share of lines that hold nothing but a comment."""
    lines = [line.strip() for path in paths for line in tree.lines(path)]
    return sum(line.startswith("//") for line in lines) / max(1, len(lines))


# Where the tests of a folder are when they are not in the folder of its name.
OTHER_TEST_FOLDERS = {
    "client/c": ["tests/c/"],
    "client/cli": [f"tests/client/{part}" for part in ("batch/", "io/", "load/", "show/", "verbs/")],
    "client/draco_child": ["tests/client/io/draco_process_test"],
    "client/examples": ["tests/c/godot_test", "tests/python/figures_test"],
    "client/python": ["tests/python/"],
}
# Suffixes of tests.
TESTS = [*CPP, ".c", ".py"]


def units(tree):
    """(name, folder of code, folders of its tests) of each row of the table: modules, then whole programs."""
    for top in PROGRAM_FOLDERS:
        for folder in sorted({"/".join(p.split("/")[:2]) for p in tree.select(CPP, [f"{top}/"]) if p.count("/") > 1}):
            name = folder.split("/")[1]
            beside = f"tests/{name}/" if top == "lib" else f"tests/{folder}/"
            yield folder, f"{folder}/", OTHER_TEST_FOLDERS.get(folder, [beside])
    for program in PROGRAM_FOLDERS[1:]:
        yield program, f"{program}/", [f"tests/{program}/"]


def print_modules(tree):
    print(f"{'module':<22}{'files':>6}{'lines':>7}{'tests':>7}{'tests/code':>12}")
    for name, code_folder, test_folders in units(tree):
        code, tests = tree.select(CPP, [code_folder]), tree.select(TESTS, test_folders)
        num_code, num_tests = count_lines(tree, code), count_lines(tree, tests)
        print(f"{name:<22}{len(code):>6}{num_code:>7}{num_tests:>7}{num_tests / max(1, num_code):>12.2f}")


def print_totals(tree, code):
    tests = tree.select(CPP, ["tests/"])
    num_code, num_tests = count_lines(tree, code), count_lines(tree, tests)
    sources = [path for path in code if path.endswith(".cpp")]
    lengths = sorted(len(tree.lines(path)) for path in sources)
    print(f"{'all':<22}{len(code):>6}{num_code:>7}{num_tests:>7}{num_tests / max(1, num_code):>12.2f}"
          "   (tests: e2e, bench, fuzz and support too)")
    print()
    if lengths:
        print(f"lines of a .cpp file: median {statistics.median(lengths):.0f}, "
              f"90 % within {lengths[len(lengths) * 9 // 10]}, longest {lengths[-1]}")
    print(f"whole-line comments: {whole_line_comments(tree, sources):.1%} of .cpp lines, "
          f"{whole_line_comments(tree, code):.1%} with headers")
    for folder, (tested, total) in test_shares(tree).items():
        print(f"same-named test, {folder}: {tested} of {total} .cpp files ({tested / max(1, total):.0%})")


def print_functions(tree, code):
    found = [(f.num_lines, f.name, path) for path in code for f in functions.functions_of(tree.text(path))]
    long = [row for row in found if row[0] > MAX_FUNCTION_LINES]
    longest = f"; the longest, {max(found)[1]}, has {max(found)[0]}" if found else ""
    print(f"functions over {MAX_FUNCTION_LINES} lines: {len(long)} of {len(found)}{longest}")
    for num_lines, name, path in sorted(long, reverse=True):
        print(f"  {num_lines} {name} ({path})")


def print_cycles(tree):
    graph = include_graph(tree, modules_of(tree))
    found = cycles(graph)
    print(f"cycles among {len(graph)} modules: {len(found)}")
    for group in found:
        print(f"  {' <-> '.join(group)}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", default=pathlib.Path(__file__).parents[2])
    tree = Tree(parser.parse_args(arguments).root)
    code = tree.select(CPP, [f"{folder}/" for folder in PROGRAM_FOLDERS])
    print_modules(tree)
    print_totals(tree, code)
    print_functions(tree, code)
    print_cycles(tree)
    return 0


if __name__ == "__main__":
    sys.exit(main())
