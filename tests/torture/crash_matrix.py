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
import os
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

    def listed(self, data, verb="sequences"):
        answer = self.run(verb, "list", "--local", "--data-dir", str(data), "--json")
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


class Template:
    """A data folder with three sequences, the last of which is newer than a backup of the folder."""

    def __init__(self, crashes, root):
        self.crashes, self.root = crashes, root
        self.data, self.backup = root / "data", root / "backup"
        self.template, self.old_backup = root / "template", root / "old-backup"
        for frames, name in ((3, "a"), (4, "b"), (5, "c")):
            make_sequence(root / name, frames)
        self.ids = {name: self.upload(name, self.template) for name in ("a", "b")}
        crashes.run("store", "backup", str(self.template), str(self.old_backup), "-q")
        self.ids["c"] = self.upload("c", self.template)

    def upload(self, name, data, *flags):
        """The id, as `pleat` prints it."""
        answer = self.crashes.run("upload", str(self.root / name), *self.local(data), *flags, "-q")
        return answer.stdout.strip()

    def local(self, data=None):
        return ["--local", "--data-dir", str(data or self.data)]

    def fresh(self, with_backup=False, template=None):
        for folder in (self.data, self.backup):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(template or self.template, self.data)
        if with_backup:
            shutil.copytree(self.old_backup, self.backup)

    def path_of(self, name):
        return self.data / "blobs" / self.ids[name][:2] / self.ids[name]

    def is_sound(self):
        return self.crashes.is_sound(self.data)

    def keeps_a_and_b(self):
        found = self.crashes.listed(self.data)
        return found is not None and {self.ids["a"], self.ids["b"]} <= found


def upload_problems(it, kills, chance):
    def without_c():
        it.fresh()
        it.crashes.run("sequences", "delete", it.ids["c"], *it.local())

    def inspect(result):
        if not it.keeps_a_and_b():
            return "an older sequence is lost"
        if it.ids["c"] in result.stdout and it.ids["c"] not in it.crashes.listed(it.data):
            return "an acknowledged upload is lost"
        return None if it.is_sound() else "the store is not sound"

    return it.crashes.matrix("upload", without_c, ["upload", str(it.root / "c"), *it.local()], inspect, kills, chance)


def delete_problems(it, kills, chance):
    def inspect(result):
        if not it.keeps_a_and_b():
            return "another sequence is lost"
        if result.returncode == 0 and it.ids["c"] in it.crashes.listed(it.data):
            return "a deleted sequence is back"
        return None if it.is_sound() else "the store is not sound"

    return it.crashes.matrix("delete", it.fresh, ["sequences", "delete", it.ids["c"], *it.local()], inspect, kills,
                             chance)


def backup_problems(it, kills, chance):
    command = ["store", "backup", str(it.data), str(it.backup)]

    def inspect(_):
        if it.crashes.listed(it.data) != set(it.ids.values()):
            return "the store itself has changed"
        if it.crashes.run(*command, "-q").returncode != 0:
            return "the backup cannot be renewed"
        return None if it.crashes.is_sound(it.backup) else "the backup is not sound"

    return it.crashes.matrix("backup", lambda: it.fresh(True), command, inspect, kills, chance)


def repair_problems(it, kills, chance):
    command = ["store", "repair", str(it.data)]

    def lost_catalog():
        it.fresh()
        for path in it.data.glob("catalogue.db*"):
            path.unlink()

    def inspect(_):
        if it.crashes.run(*command, "-q").returncode != 0:
            return "the repair cannot be done again"
        if it.crashes.listed(it.data) != set(it.ids.values()):
            return "a sequence is lost"
        return None if it.is_sound() else "the store is not sound"

    return it.crashes.matrix("repair", lost_catalog, command, inspect, kills, chance)


def sweep_problems(it, kills, chance):
    """Retention: a sequence that has lived out its time, one that is pinned, the older of two jobs, an upload."""
    template, upload_id = it.root / "sweep-template", "f" * 64
    it.fresh(template=it.template)
    for name, frames in (("brief", 6), ("pinned", 7)):
        make_sequence(it.root / name, frames)
        it.ids[name] = it.upload(name, it.data, "--ttl-hours", "1e-9")
    it.crashes.run("sequences", "pin", it.ids["pinned"], *it.local())
    for name in ("a", "b"):
        it.crashes.run("compress", str(it.root / name), "-o", str(it.root / f"{name}.plt"), "--kg", "1", *it.local())
    part = it.data / "uploads" / f"{upload_id}.part"
    part.write_text("some bytes")
    os.utime(part, (1, 1))
    shutil.copytree(it.data, template)
    command = ["store", "sweep", str(it.data), "--keep-jobs", "1"]
    compressed = it.crashes.listed(it.data, "compressed")

    def is_swept():
        jobs = it.crashes.listed(it.data, "jobs")
        return it.ids["brief"] not in it.crashes.listed(it.data) and len(jobs) == 1 and not part.exists()

    def inspect(result):
        found = it.crashes.listed(it.data)
        if found is None or not {it.ids[name] for name in ("a", "b", "c", "pinned")} <= found:
            return "a sequence that should stay is lost"
        if it.crashes.listed(it.data, "compressed") != compressed:
            return "what a deleted job has made is lost"
        if result.returncode == 0 and not is_swept():
            return "what was swept is back"
        if not it.is_sound():
            return "the store is not sound"
        if it.crashes.run(*command).returncode != 0 or not is_swept():
            return "the sweep cannot be done again"
        return None if it.is_sound() else "the store is not sound after another sweep"

    return it.crashes.matrix("sweep", lambda: it.fresh(template=template), command, inspect, kills, chance)


def scrub_problems(it, kills, chance):
    """A damaged file goes to the quarantine: it is there or in its place, and an upload mends its entry."""
    command = ["store", "scrub", str(it.data)]

    def damaged_c():
        it.fresh()
        it.path_of("c").write_text("damaged")

    def inspect(_):
        if it.crashes.listed(it.data) != {it.ids[name] for name in ("a", "b", "c")}:
            return "an entry is lost"
        quarantined = it.data / "quarantine" / it.ids["c"]
        if quarantined.exists() == it.path_of("c").exists():
            return "the damaged file is nowhere, or twice"
        it.crashes.run(*command)
        if it.path_of("c").exists() or quarantined.read_text() != "damaged":
            return "another scrub does not move the damaged file"
        if it.upload("c", it.data) != it.ids["c"]:
            return "the damaged content cannot be uploaded again"
        return None if it.is_sound() else "the store is not sound"

    return it.crashes.matrix("scrub", damaged_c, command, inspect, kills, chance)


def train_problems(it, kills, chance):
    """A training that is killed goes on, ends with the same model, and leaves no checkpoint behind."""
    folder = it.root / "performer"
    it.crashes.run("generate", "performer", "-o", str(folder), "--format", "pc2", "--frames", "24", "--vertices", "700")
    command = ["train", str(folder / "performer.pc2"), *it.local(), "--learner", "ridge", "--resolution-percent", "10", "-q"]
    it.fresh()
    it.crashes.run(*command)
    expected = it.crashes.listed(it.data, "models")

    def inspect(_):
        jobs = it.crashes.listed(it.data, "jobs")
        if jobs is None or not it.keeps_a_and_b():
            return "the folder does not open"
        for job in jobs:
            if it.crashes.run("jobs", "watch", job, *it.local()).returncode != 0:
                return "the job does not go on"
        if jobs and it.crashes.listed(it.data, "models") != expected:
            return "the model is another one"
        check = json.loads(it.crashes.run("store", "check", str(it.data), "--json").stdout)
        if check["problems"] or check["entries"]["checkpoint"] != 0:
            return "the store is not sound, or a checkpoint is left"
        return None

    if not expected or len(expected) != 1:
        return ["train: the training fails without a kill"]
    return it.crashes.matrix("train", it.fresh, command, inspect, kills, chance)


def all_problems(crashes, root, kills, chance):
    it = Template(crashes, root)
    matrices = (upload_problems, delete_problems, backup_problems, repair_problems, sweep_problems, scrub_problems,
                train_problems)
    print(f"{'command':<10} {'moments':>8} {'kills':>6} {'lost':>5}")
    problems = []
    for matrix in matrices:
        problems += matrix(it, max(1, kills // len(matrices)), chance)
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
