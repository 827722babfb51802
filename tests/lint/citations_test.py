"""Tests of citations.py and measure.py: for every rule a planted breach, and a clean twin that must pass."""

import contextlib
import io
import unittest

import citations
import markdown
import measure
from lint_test import planted
from tree import Tree

PAGE = {"docs/method/fit.md": "# The fit\n\n## Moments, in `V`\n\n## 3.2 Pose steps\n\n## Moments, in `V`\n"}

# Rule -> (text that breaks it, the same text without the breach), each in docs/a.md beside PAGE.
IN_MARKDOWN = {
    "link": ("[fit](method/fits.md)", "[fit](method/fit.md) and [docs](../docs) and [web](https://a.org/b.md)"),
    "heading": ("[fit](method/fit.md#moment)", "[fit](method/fit.md#moments-in-v) [2](method/fit.md#moments-in-v-1)"),
    "page": ("see docs/method/pose.md", "see docs/method/fit.md"),
    "bare-page": ("see fit.md", "see `fit.md`, the page that `pleat` writes"),
    "path": ("`lib/gp/src/scg.cpp`", "`build/lib/scg.cpp`\n```\n`lib/gp/src/scg.cpp`\n```\n"),
}
# The same in a comment of lib/gp/src/a.cpp.
IN_SOURCES = {
    "page": ("// docs/method/pose.md", "// docs/method/fit.md"),
    "bare-page": ("// Source: fit.md, section 3.2", '// Written to\nWrite(folder + "/fit.md");'),
    "heading": ('// See docs/method/fit.md,\n// "Moment".', '// See docs/method/fit.md,\n// "Moments, in\n// V".'),
    "path": ("// tests/gp/scg_test.cpp has the values.", "// lib/gp/src/a.cpp has the values."),
}


def breaches(files):
    with planted(PAGE | files) as root:
        return citations.check(Tree(root))


def rules_broken(files):
    return {breach.rule for breach in breaches(files)}


class CitationTest(unittest.TestCase):

    def test_every_rule_has_a_planted_breach(self):
        self.assertEqual(set(IN_MARKDOWN) | set(IN_SOURCES), set(citations.RULES))

    def test_pages(self):
        for rule, (breach, clean) in IN_MARKDOWN.items():
            with self.subTest(rule=rule):
                self.assertEqual(rules_broken({"docs/a.md": breach}), {rule})
                self.assertEqual(rules_broken({"docs/a.md": clean}), set())

    def test_sources(self):
        for rule, (breach, clean) in IN_SOURCES.items():
            with self.subTest(rule=rule):
                self.assertEqual(rules_broken({"lib/gp/src/a.cpp": breach}), {rule})
                self.assertEqual(rules_broken({"lib/gp/src/a.cpp": clean}), set())

    def test_every_kind_of_source_is_read(self):
        for name in ("a.h", "a.inc", "a.proto"):
            self.assertEqual(rules_broken({f"lib/{name}": "// method.md"}), {"bare-page"}, name)
        for name in ("a.py", "a.sh", "a.cmake", "CMakeLists.txt", "compose.yaml"):
            self.assertEqual(rules_broken({f"tests/{name}": "# method.md"}), {"bare-page"}, name)

    def test_headings_are_cited_by_anchor_by_text_and_by_number(self):
        for good in ("docs/method/fit.md#moments-in-v", 'docs/method/fit.md, "The fit"', "docs/method/fit.md, 3.2",
                     "docs/method/fit.md, section 3.2)"):
            self.assertEqual(breaches({"a.h": f"// {good}"}), [], good)
        for bad in ("docs/method/fit.md#moments", 'docs/method/fit.md, "Fit"', "docs/method/fit.md, section 3.3"):
            self.assertEqual(rules_broken({"a.h": f"// {bad}"}), {"heading"}, bad)

    def test_a_heading_of_the_same_page_must_be_there(self):
        self.assertEqual(rules_broken({"a.md": "# One\n[x](#one)"}), set())
        self.assertEqual(rules_broken({"a.md": "# One\n[x](#two)"}), {"heading"})

    def test_paths_in_code_may_be_patterns_and_stand_beside_the_page(self):
        files = {"client/cli/verb_a.cpp": "", "client/cli/verb_b.cpp": "", "client/x/src/y/z.h": ""}
        for good in ("client/cli/verb_*.cpp", "client/cli/verb_{a,b}.cpp", "client/cli/verb_<name>.cpp",
                     "client/.../z.h", "client/cli/", "z.h", "cli/verb_a.cpp", ".cpp", "*.pb.h", "a / b.c"):
            self.assertEqual(breaches(files | {"client/README.md": f"`{good}`"}), [], good)
        for bad in ("client/cli/verbs_*.cpp", "client/cli/verb_{a,c}.cpp", "client/.../q.h", "client/cly/", "q.h",
                    "cli/verb_c.cpp", "../client/cli/q.cpp"):
            self.assertEqual(rules_broken(files | {"client/README.md": f"`{bad}`"}), {"path"}, bad)

    def test_the_tool_fails_and_says_where(self):
        with planted({"docs/a.md": "\n[b](b.md)\n"}) as root:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                self.assertEqual(citations.main([str(root)]), 1)
            self.assertEqual(printed.getvalue(), "docs/a.md:2: b.md is not there [link]\n")


class MarkdownTest(unittest.TestCase):

    def test_anchors_follow_the_rule_of_github(self):
        page = "# `pleat train`: what it does\n## A_b & c\n## A_b & c\n```\n# no heading\n```\n"
        self.assertEqual(markdown.anchors(page), {"pleat-train-what-it-does", "a_b--c", "a_b--c-1"})

    def test_links_in_code_are_no_links(self):
        self.assertEqual(list(markdown.links("`[a](b)` and\n[c\nd](e#f) [g]: h\n[g]: i\n")), [(3, "e#f"), (4, "i")])


class MeasureTest(unittest.TestCase):

    FILES = {"lib/mesh/include/pleat/mesh/a.h": '#include "pleat/base/b.h"\n',
             "lib/base/include/pleat/base/b.h": "// One.\nint b;\n",
             "tests/mesh/a_test.cpp": "int a;\n"}

    def cycles(self, files):
        with planted(files) as root:
            tree = Tree(root)
            return measure.cycles(measure.include_graph(tree, measure.modules_of(tree)))

    def test_cycles_of_modules_are_found(self):
        self.assertEqual(self.cycles(self.FILES), [])
        self.assertEqual(self.cycles(self.FILES | {"lib/base/src/c.cpp": '#include "pleat/mesh/a.h"\n'}),
                         [["base", "mesh"]])

    def test_the_table_has_a_row_for_each_module(self):
        with planted(self.FILES) as root:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                self.assertEqual(measure.main([str(root)]), 0)
            rows = [line.split() for line in printed.getvalue().splitlines()]
            self.assertIn(["lib/mesh", "1", "1", "1", "1.00"], rows)
            self.assertIn(["lib/base", "1", "2", "0", "0.00"], rows)


if __name__ == "__main__":
    unittest.main()
