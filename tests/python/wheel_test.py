"""pip installs the wheel into a folder of its own, from where the package works.

usage: wheel_test.py FOLDER_OF_THE_WHEEL
"""

import json
import pathlib
import subprocess
import sys
import tempfile


def check_metadata(wheel):
    """What pip reads of the wheel: name, versions, what it needs, and what it needs for servers."""
    report = subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--dry-run",
                             "--ignore-installed", "--report", "-", wheel], check=True, capture_output=True, text=True)
    metadata = json.loads(report.stdout)["install"][0]["metadata"]
    assert metadata["name"] == "pleat" and metadata["provides_extra"] == ["server"], metadata
    needs = metadata["requires_dist"]
    assert needs[0] == "numpy" and all("extra == 'server'" in need.replace('"', "'") for need in needs[1:]), needs
    assert len(needs) == 3, needs


def main():
    wheels = list(pathlib.Path(sys.argv[1]).glob("pleat-*.whl"))
    assert len(wheels) == 1, wheels
    if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode != 0:
        print("skipped: pip is not on this machine")
        sys.exit(77)
    check_metadata(wheels[0])
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target",
                        folder, wheels[0]], check=True)
        script = "import pleat; print(pleat.__file__, pleat.__version__, pleat.performer(2, 600).num_frames)"
        done = subprocess.run([sys.executable, "-c", script], cwd=folder, check=True, capture_output=True, text=True,
                              env={"PYTHONPATH": folder})
        assert folder in done.stdout and done.stdout.split()[2] == "2", done.stdout
        assert (pathlib.Path(folder) / "pleat/py.typed").exists()
        assert (pathlib.Path(folder) / "pleat/server/__init__.py").exists()
        assert (pathlib.Path(folder) / "pleat/v1/pose_service_pb2_grpc.py").exists()
        version = subprocess.run([sys.executable, "-m", "pip", "show", "pleat"], capture_output=True, text=True,
                                 env={"PYTHONPATH": folder}).stdout
        assert "Version: " + done.stdout.split()[1] in version, version
    print(wheels[0].name, "installs and works")


if __name__ == "__main__":
    main()
