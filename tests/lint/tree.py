"""The files that the static gate looks at, and the three views of a line that its rules ask for."""

import functools
import os
import pathlib
import posixpath
import re
import subprocess

CPP = (".h", ".cpp", ".inc")
CODE = CPP + (".proto", ".py", ".sh")

# A string or character literal, or a comment that runs to the end of the line.
_LITERAL_OR_COMMENT = re.compile(r'''("(?:\\.|[^"\\])*"|(?<![\w'])'(?:\\.|[^'\\])+')|//.*''')


class Tree:
    """A source tree. Paths are relative to the root and use forward slashes."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.paths = _tracked(self.root) if (self.root / ".git").exists() else _walk(self.root)
        self._known = set(self.paths)
        for path in self.paths:
            self._known.update(str(parent) for parent in pathlib.PurePosixPath(path).parents)

    def select(self, suffixes, where=("",)):
        """The paths with one of these suffixes that begin with one of the prefixes of `where`."""
        return [p for p in self.paths if p.endswith(tuple(suffixes)) and p.startswith(tuple(where))]

    def exists(self, path):
        """True for a file of the tree and for a folder that holds one."""
        return posixpath.normpath(path) in self._known

    @functools.lru_cache(maxsize=None)
    def text(self, path):
        return (self.root / path).read_text(encoding="utf-8", errors="replace")

    def lines(self, path):
        return self.text(path).splitlines()


def code_of(line):
    """A C++ line without its comment and without the contents of its literals."""
    return _LITERAL_OR_COMMENT.sub(lambda match: '""' if match[1] else "", line)


def comment_of(line):
    """What stands behind // in a C++ line; empty where no comment is."""
    for match in _LITERAL_OR_COMMENT.finditer(line):
        if match[1] is None:
            return match[0].lstrip("/")
    return ""


def include_of(line):
    """What a line includes, such as pleat/mesh/topology.h; empty for any other line."""
    match = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
    return match[1] if match else ""


def _tracked(root):
    """The files that git tracks, less those that are deleted but not yet committed."""
    listing = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, text=True, check=True)
    return sorted(p for p in set(listing.stdout.split("\0")) if p and (root / p).is_file())


def _walk(root):
    found = []
    for folder, _, names in os.walk(root):
        found += [(pathlib.Path(folder) / name).relative_to(root).as_posix() for name in names]
    return sorted(found)
