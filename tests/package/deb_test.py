"""Builds the Debian package, and looks at it as a machine that installs it would.

usage: deb_test.py BUILD_FOLDER
"""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def run(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, text=True, **more).stdout


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def installed_packages():
    """The packages of this machine, and the names that they provide."""
    names = set()
    for line in run("dpkg-query", "-W", "-f=${Status}|${Package}|${Provides}\n").splitlines():
        state, package, provided = line.split("|", 2)
        if state == "install ok installed":
            names |= {package} | {part.split()[0] for part in provided.split(",") if part.strip()}
    return names


def check_fields(deb):
    fields = run("dpkg-deb", "--field", str(deb))
    assert re.search(r"^Package: pleat$", fields, re.M), fields
    depends = re.search(r"^Depends: (.*)$", fields, re.M)[1]
    packages = [re.match(r"[^ (|]+", part.strip())[0] for part in depends.split(",")]
    assert any(package.startswith("libgrpc++") for package in packages), depends
    missing = set(packages) - installed_packages()
    assert not missing, f"the package asks for {missing}, with which it was not built"


def check_programs(root):
    for program, words in (("pleat", ["version"]), ("pleatd", ["--version"]), ("pleat", ["--help"])):
        assert run(str(root / "usr/bin" / program), *words)
    with tempfile.TemporaryDirectory() as folder:
        run(str(root / "usr/bin/pleat"), "generate", "performer", "--frames", "4", "--vertices", "500", "-o", folder + "/p")
        told = run(str(root / "usr/bin/pleat"), "inspect", folder + "/p/performer.pc2")
        assert "4" in told, told


def check_files(root):
    for path in ("usr/bin/pleat-draco", "usr/share/bash-completion/completions/pleat", "usr/share/zsh/vendor-completions/_pleat",
                 "usr/share/fish/vendor_completions.d/pleat.fish", "usr/share/doc/pleat/copyright"):
        assert (root / path).stat().st_size > 0, path
    unit = (root / "usr/lib/systemd/system/pleatd.service").read_text()
    assert "ExecStart=/usr/bin/pleatd" in unit
    manual = gzip.decompress((root / "usr/share/man/man1/pleat.1.gz").read_bytes()).decode()
    assert ".SS train" in manual
    if shutil.which("groff"):
        drawn = subprocess.run(["groff", "-man", "-ww", "-Tascii", "-P-cbou"], input=manual, capture_output=True, text=True, check=True)
        assert "EXIT STATUS" in drawn.stdout
        assert not drawn.stderr.strip(), drawn.stderr
    script = root / "usr/share/bash-completion/completions/pleat"
    run("bash", "-n", str(script))


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    for tool in ("cpack", "dpkg-deb", "dpkg-shlibdeps"):
        if not shutil.which(tool):
            skip(f"{tool} is not there")
    with tempfile.TemporaryDirectory() as folder:
        # The programs were built before; this makes the page and the completions.
        run("cmake", "--build", str(build), "--target", "package_files", env={**os.environ, "LC_ALL": "C"})
        run("cpack", "--config", str(build / "CPackConfig.cmake"), "-B", folder, cwd=folder)
        debs = list(pathlib.Path(folder).glob("*.deb"))
        assert len(debs) == 1, debs
        check_fields(debs[0])
        root = pathlib.Path(folder) / "root"
        run("dpkg-deb", "-x", str(debs[0]), str(root))
        check_programs(root)
        check_files(root)
    print("passed")


if __name__ == "__main__":
    main()
