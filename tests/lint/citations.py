"""Checks that every page, heading and file that the tree cites is there. Prints each breach and fails.

usage: citations.py [ROOT] [--update]
  --update  writes the counts of tests/lint/known_breaches.txt down, never up

In Markdown: links with their anchors, paths in `code`, pages named in the text. In sources: pages and files named
in comments, with a heading as `docs/page.md#heading`, `docs/page.md, "Heading"` or `docs/page.md, section 3.2`.
"""

import argparse
import fnmatch
import pathlib
import posixpath
import re
import sys

import known
import markdown
from rules import Breach
from tree import CPP, Tree, comment_of

RULES = {
    "link": "a link leads to a file or folder of the tree",
    "heading": "a cited heading is in the page",
    "page": "a cited page is in the tree",
    "bare-page": "a page is cited by its path, such as docs/method/fit.md",
    "path": "a cited file or folder is in the tree",
}
TOP_FOLDERS = ("lib", "server", "client", "tests", "docs", "cmake", "docker", "proto")
COMMENT_SUFFIXES = (".py", ".sh", ".cmake", "CMakeLists.txt", ".yaml", ".yml")
PLANTED = ("tests/lint/",)  # the tests of the gate cite what is not there, on purpose

# A page, then perhaps its heading in one of three forms. A comment may wrap inside it.
_PAGE = re.compile(r'(?<![\w/.<>*"-])((?:[\w.-]+/)*[\w-]+\.md)\b'
                   r'(?:#([\w-]+)|,\s*"([^"]+)"|(?:,\s+|,?\s+section\s+)(\d+(?:\.\d+)*)\b)?')
_SOURCE_PATH = re.compile(rf"(?<![\w/.-])((?:{'|'.join(TOP_FOLDERS)})/[\w./-]+\.(?!md\b)\w+)")
_PATH = re.compile(r"[\w.*{},<>~-]+(?:/[\w.*{},<>-]*)*")


def check_links(tree, path):
    """Links of a page: the file must be there, and for a page the heading too."""
    for line, target in markdown.links(tree.text(path)):
        name, _, anchor = target.partition("#")
        goal = _resolve(path, name) if name else path
        if not tree.exists(goal):
            yield Breach("link", path, line, f"{target} is not there")
        elif anchor and goal.endswith(".md") and anchor not in markdown.anchors(tree.text(goal)):
            yield Breach("heading", path, line, f"{goal} has no heading #{anchor}")


def check_code_spans(tree, path):
    """Paths in `code`: below a folder of the root or beside the page; a bare name of a source anywhere."""
    for line, span in markdown.code_spans(tree.text(path)):
        if not _PATH.fullmatch(span) or span.startswith(("build/", "*.")):
            continue
        first, slash, _ = (_resolve(path, span) if span.startswith("../") else span).partition("/")
        is_source = span.endswith(CPP) and span not in CPP
        if slash and (first in TOP_FOLDERS or is_source or tree.exists(_resolve(path, first))):
            candidates = [span, _resolve(path, span)]
        elif not slash and is_source:
            candidates = [f"**/{span}"]
        else:
            continue
        if not any(_matches(tree, candidate) for candidate in candidates):
            yield Breach("path", path, line, f"`{span}` is not there")


def check_mentions(tree, path, text):
    """Pages and their headings that a text names, and files of the tree that a comment names."""
    for match in _PAGE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        goal = _page_of(tree, path, match[1])
        if goal is None:
            rule = "page" if "/" in match[1] else "bare-page"
            yield Breach(rule, path, line, f"{match[1]}: {RULES[rule]}")
        else:
            yield from _check_heading(tree, goal, match, Breach("heading", path, line, ""))
    for match in _SOURCE_PATH.finditer(text) if not path.endswith(".md") else ():
        if not _matches(tree, match[1].rstrip(".")):
            line = text.count("\n", 0, match.start()) + 1
            yield Breach("path", path, line, f"{match[1]} is not there")


def _check_heading(tree, page, match, breach):
    _, anchor, heading, number = match.groups()
    text, message = tree.text(page), ""
    if anchor and anchor not in markdown.anchors(text):
        message = f"{page} has no heading #{anchor}"
    elif heading and not _has_heading(text, re.sub(r"\s+", " ", heading)):
        message = f'{page} has no heading "{heading}"'
    elif number and not any(re.match(rf"{re.escape(number)}(?![\d])", h) for h in markdown.headings(text)):
        message = f"{page} has no section {number}"
    if message:
        yield Breach(breach.rule, breach.path, breach.line, message)


def _has_heading(text, wanted):
    return any(heading.casefold() == wanted.casefold() for heading in markdown.headings(text))


def _page_of(tree, path, name):
    """The path of a cited page. A bare name stands for a page of the root or, in Markdown, of the same folder."""
    if tree.exists(name):
        return posixpath.normpath(name)
    beside = _resolve(path, name)
    return beside if tree.exists(beside) and ("/" in name or path.endswith(".md")) else None


def _resolve(page, target):
    """A target of a page as a path from the root; a leading slash means the root."""
    folder = "" if target.startswith("/") else posixpath.dirname(page)
    return posixpath.normpath(posixpath.join(folder, target.lstrip("/")))


def _matches(tree, pattern):
    """True when a file or folder fits: *, {a,b}, <name> and ... (any folders) stand for what they look like."""
    pattern = re.sub(r"<[^>]*>", "*", pattern.rstrip("/")).replace("/.../", "/**/")
    for choice in _expand_braces(pattern):
        if choice.startswith("**/"):
            found = any(fnmatch.fnmatchcase(path, choice[1:]) or fnmatch.fnmatchcase(path, choice[3:])
                        for path in tree.paths)
        elif "*" in choice:
            found = any(fnmatch.fnmatchcase(path, choice) for path in tree.paths)
        else:
            found = tree.exists(choice)
        if not found:
            return False
    return True


def _expand_braces(pattern):
    match = re.search(r"\{([^{}]*)\}", pattern)
    if not match:
        return [pattern]
    return [full for choice in match[1].split(",")
            for full in _expand_braces(pattern[:match.start()] + choice + pattern[match.end():])]


def _comments(tree, path):
    """The comments of a source, line by line; other languages whole, their # blank."""
    if path.endswith(CPP + (".proto",)):
        lines = [comment_of(line) for line in tree.lines(path)]
    else:
        lines = [re.sub(r"^\s*#", "", line) for line in tree.lines(path)]
    return "\n".join(lines)


def check(tree):
    found = []
    for path in tree.select([".md"]):
        found += check_links(tree, path)
        found += check_code_spans(tree, path)
        found += check_mentions(tree, path, markdown.prose(tree.text(path)))
    sources = tree.select(CPP + (".proto",) + COMMENT_SUFFIXES) + [p for p in tree.paths if p == "dev"]
    for path in sources:
        if not path.startswith(PLANTED):
            found += check_mentions(tree, path, _comments(tree, path))
    return found


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", default=pathlib.Path(__file__).parents[2])
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args(arguments)
    tree = Tree(options.root)
    return known.settle(tree.root, check(tree), set(RULES), options.update)


if __name__ == "__main__":
    sys.exit(main())
