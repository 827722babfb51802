#!/usr/bin/env python3
"""Fills the disk of a running pleatd, really, and looks at what still works.

The data folder is a tmpfs of a few megabytes in a mount namespace of its own, and nothing is kept free
(--reserve-bytes 0), so that writes fail in the middle of a file, of SQLite and of its log.

usage: full_disk.py PLEAT PLEATD     exit code 1 when something was lost or does not come back
Exit code 77, with a word, where a user may not mount.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
DISK_BYTES = 24 << 20
INSIDE = "PLEAT_FULL_DISK_INSIDE"


def enter_namespace():
    """Runs this program again where it may mount; returns its exit code, or None inside."""
    if os.environ.get(INSIDE):
        return None
    try:
        allowed = subprocess.run(["unshare", "--map-root-user", "--mount", "mount", "-t", "tmpfs", "none", "/mnt"],
                                 capture_output=True).returncode == 0
    except FileNotFoundError:
        allowed = False
    if not allowed:
        print("skipped: this user may not mount a small disk (unshare --map-root-user --mount)")
        return SKIPPED
    return subprocess.run(["unshare", "--map-root-user", "--mount", sys.executable, *sys.argv],
                          env={**os.environ, INSIDE: "1"}).returncode


class Server:
    def __init__(self, pleat, pleatd, data):
        self.pleat, self.data = pleat, data
        self.process = subprocess.Popen(
            [pleatd, "--data-dir", str(data), "--listen", "127.0.0.1:0", "--reserve-bytes", "0", "--allow-root"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = self.process.stdout.readline().split()[-1]

    def run(self, *arguments):
        return subprocess.run([self.pleat, *arguments, "--server", self.address, "-q"], capture_output=True, text=True,
                              timeout=120)

    def upload(self, path):
        answer = self.run("upload", str(path))
        return answer.stdout.strip() if answer.returncode == 0 else None

    def sequences(self):
        answer = self.run("sequences", "list", "--json")
        return {entry["id"] for entry in json.loads(answer.stdout)} if answer.returncode == 0 else None

    def can_store(self):
        return self.run("status", "--can-store").returncode == 0

    def wait_until(self, condition):
        while not condition():
            if self.process.poll() is not None:
                return False
        return True

    def end(self):
        self.process.terminate()
        return self.process.wait(timeout=60) == 0


def make_clip(path, frames, vertices=2000):
    """A point cache of so many frames, beside its mesh."""
    columns = vertices // 4
    lines = [f"v {i // 4} {i % 4} 0" for i in range(vertices)]
    lines += [f"f {4 * c + 1} {4 * c + 2} {4 * c + 6} {4 * c + 5}" for c in range(columns - 1)]
    path.with_suffix(".obj").write_text("\n".join(lines) + "\n")
    from array import array
    header = b"POINTCACHE2\0" + array("i", [1, vertices]).tobytes() + array("f", [0, 1]).tobytes()
    header += array("i", [frames]).tobytes()
    frame = array("f")
    for i in range(vertices):
        frame.extend((i // 4, i % 4, frames))
    path.write_bytes(header + frame.tobytes() * frames)
    return path


def fill(path):
    """Writes until nothing fits any more."""
    with open(path, "wb", buffering=0) as file:
        try:
            while True:
                file.write(b"x" * 4096)
        except OSError:
            return


def problems_of(pleat, pleatd, root):
    disk = root / "disk"
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "none", str(disk)], check=True)
    small, large = make_clip(root / "small.pc2", 20), make_clip(root / "large.pc2", 200)
    server = Server(pleat, pleatd, disk / "data")
    problems = []

    def expect(what, is_so):
        print(f"{'ok' if is_so else 'NOT GOOD':<9} {what}", flush=True)
        if not is_so:
            problems.append(what)

    first = server.upload(small)
    expect("a clip is stored while there is room", first is not None)
    fill(disk / "ballast")
    expect("an upload to the full disk is refused", server.upload(large) is None)
    expect("what was stored is listed", server.sequences() == {first})
    expect("the server says that it cannot store", server.wait_until(lambda: not server.can_store()))
    expect("a job on the full disk is refused or fails, and the server stays",
           server.run("compress", str(small), "-o", str(root / "x.plt"), "--kg", "1").returncode != 0
           and server.process.poll() is None)
    (disk / "ballast").unlink()
    expect("the server says that it can store again", server.wait_until(server.can_store))
    second = server.upload(large)
    expect("the upload goes through when there is room again", second is not None)
    expect("both are listed", server.sequences() == {first, second})
    expect("deleting gives the room back",
           server.run("sequences", "delete", second).returncode == 0 and server.sequences() == {first})
    expect("the server ends by itself", server.end())
    check = subprocess.run([pleat, "store", "check", str(disk / "data"), "--json"], capture_output=True, text=True)
    expect("the store is sound", check.returncode == 0 and not json.loads(check.stdout)["problems"])
    return problems


def main():
    if len(sys.argv) != 3:
        print(__doc__)
        return 2
    code = enter_namespace()
    if code is not None:
        return code
    with tempfile.TemporaryDirectory() as folder:
        try:
            problems = problems_of(sys.argv[1], sys.argv[2], Path(folder))
        finally:
            subprocess.run(["umount", "-l", str(Path(folder) / "disk")], stderr=subprocess.DEVNULL)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
