#!/usr/bin/env python3
"""Kills `pleat` at system calls that change the disk, and looks at what is left.

A run of a command is killed (SIGKILL, injected by strace) at its n-th write, fsync, rename or unlink.
Then the folder must open as if nothing had happened: whatever was acknowledged is there, whatever was
deleted is gone, no entry is without its file, and no file is without an entry except in quarantine.

usage: crash_matrix.py PLEAT [--kills N] [--seed S]     prints a table; exit code 1 when anything was lost
Exit code 77, with a word, where strace is missing or may not trace.
"""

import argparse
import collections
import json
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

CALLS = ("write", "pwrite64", "fsync", "fdatasync", "rename", "unlink", "ftruncate")
SKIPPED = 77


class Crashes:
    def __init__(self, pleat, root):
        self.pleat, self.root = pleat, root
        self.lost = collections.Counter()

    def run(self, *arguments, trace=None):
        command = [self.pleat, *arguments]
        if trace:
            command = ["strace", "-f", "-qq", *trace, *command]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    def listed(self, data):
        answer = self.run("sequences", "list", "--local", "--data-dir", str(data), "--json")
        if answer.returncode != 0:
            return None
        return {entry["id"] for entry in json.loads(answer.stdout)}

    def is_sound(self, folder):
        answer = self.run("store", "check", str(folder), "--json")
        return answer.returncode == 0 and not json.loads(answer.stdout)["problems"]

    def calls_of(self, arguments):
        """How often a run of the command makes each of CALLS."""
        log = self.root / "calls"
        self.run(*arguments, trace=["-e", "trace=" + ",".join(CALLS), "-o", str(log)])
        names = (re.match(r"\d+\s+(\w+)\(", line) for line in log.read_text().splitlines())
        return collections.Counter(match.group(1) for match in names if match)

    def killed(self, arguments, call, when):
        inject = ["-e", f"trace={call}", "-e", f"inject={call}:signal=KILL:when={when}", "-o", "/dev/null"]
        return self.run(*arguments, trace=inject)

    def matrix(self, name, prepare, arguments, inspect, kills, chance):
        """prepare() makes fresh folders; inspect(result) returns what was lost, or None."""
        prepare()
        counts = self.calls_of(arguments)
        moments = [(call, n) for call, count in counts.items() for n in range(1, count + 1)]
        chosen = moments if len(moments) <= kills else chance.sample(moments, kills)
        problems, num_killed = [], 0
        for call, when in sorted(chosen):
            prepare()
            result = self.killed(arguments, call, when)
            num_killed += result.returncode in (-signal.SIGKILL, 128 + signal.SIGKILL)
            problem = inspect(result)
            if problem:
                problems.append(f"{name}, {call} {when}: {problem}")
        print(f"{name:<10} {len(moments):>8} {num_killed:>6} {len(problems):>5}", flush=True)
        if num_killed == 0:
            problems.append(f"{name}: nothing was killed, so nothing is shown")
        return problems


def make_sequence(path, frames):
    path.mkdir()
    for frame in range(frames):
        lift = frame * 0.1
        (path / f"{frame:03}.obj").write_text(
            f"v 0 {lift} 0\nv 1 {lift} 0\nv 0 {lift + 1} 0\nv 0 {lift} 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")


def all_problems(crashes, root, kills, chance):
    for frames, name in ((3, "a"), (4, "b"), (5, "c")):
        make_sequence(root / name, frames)
    template, data, backup = root / "template", root / "data", root / "backup"
    local = ["--local", "--data-dir"]
    ids = {}
    for name in ("a", "b"):
        ids[name] = crashes.run("upload", str(root / name), *local, str(template), "-q").stdout.strip()
    old_backup = root / "old-backup"
    crashes.run("store", "backup", str(template), str(old_backup), "-q")
    crashes.run("upload", str(root / "c"), *local, str(template), "-q")
    ids["c"] = (crashes.listed(template) - {ids["a"], ids["b"]}).pop()

    def fresh(with_backup=False):
        for folder in (data, backup):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(template, data)
        if with_backup:
            shutil.copytree(old_backup, backup)

    def without_c():
        fresh()
        crashes.run("sequences", "delete", ids["c"], *local, str(data))

    def after_upload(result):
        found = crashes.listed(data)
        if found is None or not {ids["a"], ids["b"]} <= found:
            return "an older sequence is lost"
        if ids["c"] in result.stdout and ids["c"] not in found:
            return "an acknowledged upload is lost"
        return None if crashes.is_sound(data) else "the store is not sound"

    def after_delete(result):
        found = crashes.listed(data)
        if found is None or not {ids["a"], ids["b"]} <= found:
            return "another sequence is lost"
        if result.returncode == 0 and ids["c"] in found:
            return "a deleted sequence is back"
        return None if crashes.is_sound(data) else "the store is not sound"

    def after_backup(_):
        if not crashes.listed(data) == set(ids.values()):
            return "the store itself has changed"
        if crashes.run("store", "backup", str(data), str(backup), "-q").returncode != 0:
            return "the backup cannot be renewed"
        return None if crashes.is_sound(backup) else "the backup is not sound"

    def lost_catalog():
        fresh()
        for path in data.glob("catalogue.db*"):
            path.unlink()

    def after_repair(_):
        if crashes.run("store", "repair", str(data), "-q").returncode != 0:
            return "the repair cannot be done again"
        if crashes.listed(data) != set(ids.values()):
            return "a sequence is lost"
        return None if crashes.is_sound(data) else "the store is not sound"

    print(f"{'command':<10} {'moments':>8} {'kills':>6} {'lost':>5}")
    share = max(1, kills // 4)
    problems = crashes.matrix("upload", without_c, ["upload", str(root / "c"), *local, str(data)], after_upload,
                              share, chance)
    problems += crashes.matrix("delete", fresh, ["sequences", "delete", ids["c"], *local, str(data)], after_delete,
                               share, chance)
    problems += crashes.matrix("backup", lambda: fresh(True), ["store", "backup", str(data), str(backup)],
                               after_backup, share, chance)
    problems += crashes.matrix("repair", lost_catalog, ["store", "repair", str(data)], after_repair, share, chance)
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pleat")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if not shutil.which("strace") or subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"]).returncode != 0:
        print("skipped: strace is not on this machine (./dev setup --all), or it may not trace")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        problems = all_problems(Crashes(options.pleat, root), root, options.kills, random.Random(options.seed))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
