"""Code blocks of a page of the guide, which tests compile and run."""

import pathlib
import re

GUIDE = pathlib.Path(__file__).parents[2] / "docs/guide"


def blocks_of(page, language):
    """The fenced blocks of a language, in the order of the page."""
    text = (GUIDE / page).read_text()
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def block_named(page, language, name):
    """The one block whose first line names the file."""
    found = [block for block in blocks_of(page, language) if name in block.splitlines()[0]]
    assert len(found) == 1, f"{page} has {len(found)} blocks of {name}"
    return found[0]
