"""Packs the add-on: its Python files, and the C libraries without debug symbols beside them.

usage: make_addon.py OUT.zip STRIP LIBRARY...     each LIBRARY is a file lib*.so

STRIP is the program that takes debug symbols out. The same files give the same bytes.
"""

import pathlib
import subprocess
import sys
import tempfile
import zipfile

PACKAGE = pathlib.Path(__file__).parent / "pleat_blender"
TIME = (1980, 1, 1, 0, 0, 0)  # archives carry no time of their own


def stripped(library, strip):
    with tempfile.NamedTemporaryFile() as file:
        subprocess.run([strip, "--strip-unneeded", "-o", file.name, library], check=True)
        return pathlib.Path(file.name).read_bytes()


def main():
    out, strip, libraries = pathlib.Path(sys.argv[1]), sys.argv[2], map(pathlib.Path, sys.argv[3:])
    files = {f"{PACKAGE.name}/{path.name}": path.read_bytes()
             for path in sorted(PACKAGE.iterdir()) if path.suffix in (".py", ".toml")}
    for library in libraries:
        files[f"{PACKAGE.name}/lib/{library.name}"] = stripped(library, strip)
    part = out.with_suffix(".part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    part.replace(out)
    print(f"{out.name}, {out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
