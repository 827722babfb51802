"""Headings, links and prose of Markdown pages, as GitHub shows them."""

import re


def without_fences(text):
    """The page with the lines of its code fences blank, so that line numbers stay what they are."""
    lines, fence = [], ""
    for line in text.splitlines():
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence:
            lines.append("")
            fence = "" if mark and mark[1].startswith(fence) else fence
        elif mark:
            lines.append("")
            fence = mark[1]
        else:
            lines.append(line)
    return "\n".join(lines)


def headings(text):
    """The texts of the headings, without their marks."""
    found = re.findall(r"^#{1,6}\s+(.+?)\s*#*$", without_fences(text), re.MULTILINE)
    return [_plain(heading) for heading in found]


def anchors(text):
    """What may stand behind # in a link to the page: slugs of headings, and explicit anchors."""
    seen, found = {}, set(re.findall(r'<a\s+(?:id|name)="([^"]+)"', text))
    for heading in headings(text):
        slug = slug_of(heading)
        found.add(f"{slug}-{seen[slug]}" if slug in seen else slug)
        seen[slug] = seen.get(slug, 0) + 1
    return found


def slug_of(heading):
    """GitHub's rule: lower case, punctuation dropped, each space a hyphen."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def links(text):
    """(line, target) of each link, image and reference; addresses of other sites are left out."""
    text = re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", lambda match: " " * len(match[0]), without_fences(text))
    for match in re.finditer(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)|^\[[^\]]+\]:\s*(\S+)", text, re.MULTILINE):
        target = match[1] or match[2]
        if not re.match(r"[a-z][a-z0-9+.-]*:", target):
            yield text.count("\n", 0, match.start()) + 1, target


def code_spans(text):
    """(line, contents) of each `span` of code that lies within a line."""
    for number, line in enumerate(without_fences(text).splitlines(), 1):
        for match in re.finditer(r"(?<!`)`([^`]+)`(?!`)", line):
            yield number, match[1]


def prose(text):
    """The page without fences, spans of code and targets of links; line numbers stay what they are."""
    text = re.sub(r"(?<!`)`[^`\n]+`(?!`)", "", without_fences(text))
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", "", text)


def _plain(heading):
    heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return heading.replace("`", "").replace("*", "")
