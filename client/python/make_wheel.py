"""Writes the package of a build folder as a wheel (PEP 427), which `pip install` takes.

usage: make_wheel.py FOLDER VERSION STRIP     FOLDER/pleat -> FOLDER/pleat-VERSION-TAG.whl

STRIP is the program that takes debug symbols out of the module.
"""

import base64
import hashlib
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

METADATA = """Metadata-Version: 2.1
Name: pleat
Version: {version}
Summary: Mesh animations as characters: rig, learn, pose, compress
License: Apache-2.0
Requires-Python: >=3.11
Requires-Dist: numpy
Provides-Extra: server
Requires-Dist: grpcio >=1.51 ; extra == 'server'
Requires-Dist: protobuf <6,>=4.21 ; extra == 'server'
Classifier: Typing :: Typed
Description-Content-Type: text/markdown

Pleat turns a mesh animation into an editable character: a skeleton and a learned model of its folds.
"""
WHEEL = """Wheel-Version: 1.0
Generator: pleat make_wheel
Root-Is-Purelib: false
Tag: {tag}
"""
# The same bytes for the same package: archives carry no time of their own.
TIME = (1980, 1, 1, 0, 0, 0)


def tag_of_this_python():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def stripped(module, strip):
    with tempfile.NamedTemporaryFile() as file:
        subprocess.run([strip, "--strip-unneeded", "-o", file.name, module], check=True)
        return pathlib.Path(file.name).read_bytes()


def main():
    folder, version, strip = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    tag = tag_of_this_python()
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    files = {str(path.relative_to(folder)): path.read_bytes() for path in sorted((folder / "pleat").rglob("*"))
             if path.suffix in (".py", ".pyi") or path.name == "py.typed"}
    files[f"pleat/_pleat{suffix}"] = stripped(folder / f"pleat/_pleat{suffix}", strip)
    info = f"pleat-{version}.dist-info"
    files[f"{info}/METADATA"] = METADATA.format(version=version).encode()
    files[f"{info}/WHEEL"] = WHEEL.format(tag=tag).encode()
    record = "".join(record_line(name, data) for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    for old in folder.glob("pleat-*.whl"):
        old.unlink()
    wheel = folder / f"pleat-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            archive.writestr(entry, data)
    print(wheel.name)


if __name__ == "__main__":
    main()
