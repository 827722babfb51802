"""The list of known breaches (`known_breaches.txt`), which can only shrink.

A line is `rule path count`, perhaps with `# reason`. A tool fails when a file breaks a rule more often than its
line says, and also when it breaks it less often: then `--update` writes the smaller count. `--update` refuses to
let the total of a rule grow; a file that moves takes its breaches along.
"""

import collections
import dataclasses
import pathlib

HEADER = """\
# Breaches of the static gate that were there when their rule was made: rule, path, count, perhaps a reason.
# The list can only shrink. After repairs: python3 tests/lint/structure.py --update (or citations.py --update).
"""


@dataclasses.dataclass(frozen=True)
class Entry:
    count: int
    reason: str = ""


def read(path):
    """{(rule, path): Entry}; empty where there is no list."""
    entries = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        body, _, reason = line.partition("#")
        if body.strip():
            rule, name, count = body.split()
            entries[rule, name] = Entry(int(count), reason.strip())
    return entries


def write(path, entries):
    lines = []
    for (rule, name), entry in sorted(entries.items()):
        lines.append(f"{rule} {name} {entry.count}" + (f"  # {entry.reason}" if entry.reason else ""))
    path.write_text(HEADER + "".join(f"{line}\n" for line in lines))


def compare(breaches, entries, rules):
    """What to print: breaches beyond the known ones, and known ones that are gone."""
    found = collections.defaultdict(list)
    for breach in breaches:
        found[breach.rule, breach.path].append(breach)
    complaints = []
    for key, group in sorted(found.items()):
        known = entries.get(key, Entry(0)).count
        if len(group) > known:
            complaints += [str(breach) for breach in group]
            if known:
                complaints.append(f"{key[1]}: {len(group)} breaches of {key[0]}, of which {known} are known")
    for (rule, name), entry in sorted(entries.items()):
        count = len(found.get((rule, name), ()))
        if rule in rules and count < entry.count:
            complaints.append(f"{name}: {count} breaches of {rule}, no longer {entry.count}: run --update")
    return complaints


def updated(breaches, entries, rules):
    """(the new entries, complaints). The lines of other tools' rules stay; a total that grew is refused."""
    counts = collections.Counter((breach.rule, breach.path) for breach in breaches)
    total_found, total_known = collections.Counter(), collections.Counter()
    for (rule, _), count in counts.items():
        total_found[rule] += count
    for (rule, _), entry in entries.items():
        total_known[rule] += entry.count
    grown = [f"{rule}: {total_found[rule]} breaches, {total_known[rule]} known: the list can only shrink"
             for rule in sorted(total_found) if total_found[rule] > total_known[rule]]
    if grown:
        return entries, grown
    result = {key: entry for key, entry in entries.items() if key[0] not in rules}
    for key, count in counts.items():
        result[key] = Entry(count, entries.get(key, Entry(0)).reason)
    return result, []


def settle(root, breaches, rules, update):
    """The end of a tool: compares with the list of this tree, or rewrites it; prints and returns the exit code."""
    path = pathlib.Path(root, "tests/lint/known_breaches.txt")
    entries = read(path)
    if update:
        entries, complaints = updated(breaches, entries, rules)
        if not complaints:
            write(path, entries)
    else:
        complaints = compare(breaches, entries, rules)
    for complaint in complaints:
        print(complaint)
    return 1 if complaints else 0
