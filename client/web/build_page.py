"""Builds the page of the studio and writes page_files.cpp, which embeds it in pleatd.

With node and the packages of package-lock.json (in --packages/node_modules) the page is type-checked and bundled by
build.mjs. Without them it is one page that says what to do, so that pleatd builds on a machine without node.
"""

import argparse
import gzip
import hashlib
import html
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
         ".css": "text/css; charset=utf-8", ".wasm": "application/wasm", ".svg": "image/svg+xml",
         ".txt": "text/plain; charset=utf-8"}
WORDS = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Pleat studio</title>
<style>body { font: 16px/1.5 system-ui; max-width: 40em; margin: 4em auto; padding: 0 1em }</style>
<h1>The studio is not in this build</h1>
<p>This pleatd was built on a machine without {missing}. Its server works: the command line, gRPC, and the calls that
the studio makes. To have the page as well, install node and npm (<code>./dev setup --all</code> does on Debian), and
build again with <code>./dev build</code>, which fetches the packages of <code>client/web/package-lock.json</code>.</p>
"""


def bundle(arguments, folder):
    """Copies the sources beside the packages, where node finds them, and runs build.mjs there."""
    work = pathlib.Path(arguments.packages)
    for name in ("src", "static"):
        shutil.rmtree(work / name, ignore_errors=True)
        shutil.copytree(HERE / name, work / name)
    for name in ("build.mjs", "tsconfig.json"):
        shutil.copy(HERE / name, work / name)
    subprocess.run([arguments.node, "build.mjs", "--protoc", arguments.protoc, "--protos", arguments.protos,
                    "--out", str(folder)], cwd=work, check=True)


def write_sources(folder, packed, path):
    lines = ['#include "pleat/http/page_files.h"', ""]
    rows = []
    for number, file in enumerate(sorted(p for p in folder.rglob("*") if p.is_file())):
        data = file.read_bytes()
        target = packed / f"{number}.gz"
        target.write_bytes(gzip.compress(data, 9, mtime=0))
        name = f"pleat_page_{number}"
        # The digest changes this source with the file, so that it is compiled again.
        digest = hashlib.sha256(data).hexdigest()[:16]
        lines += [f'asm(".section .rodata\\n.global {name}\\n{name}:\\n.incbin \\"{target}\\"\\n"',
                  f'    ".global {name}_end\\n{name}_end:\\n.byte 0\\n.previous\\n");',
                  f'extern "C" const char {name}[], {name}_end[];']
        rows.append(f'      {{"/{file.relative_to(folder).as_posix()}", "{TYPES[file.suffix]}",\n'
                    f'       {{{name}, static_cast<size_t>({name}_end - {name})}}, "\\"{digest}\\""}},')
    lines += ["", "namespace pleat {", "", "const std::vector<PageFile>& PageFiles() {",
              "  static const std::vector<PageFile>& files = *new std::vector<PageFile>{", *rows, "  };",
              "  return files;", "}", "", "}  // namespace pleat", ""]
    path.write_text("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for flag in ("--node", "--packages", "--protoc", "--protos", "--out"):
        parser.add_argument(flag, required=True)
    arguments = parser.parse_args()
    out = pathlib.Path(arguments.out)
    folder, packed = out / "files", out / "packed"
    for path in (folder, packed):
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir(parents=True)
    has_node = arguments.node and not arguments.node.endswith("NOTFOUND")
    has_packages = (pathlib.Path(arguments.packages) / "node_modules/esbuild").is_dir()
    if has_node and has_packages:
        bundle(arguments, folder)
    else:
        missing = "node" if not has_node else "the packages of the page, which npm brings"
        (folder / "index.html").write_text(WORDS.replace("{missing}", html.escape(missing)))
        print(f"studio: without {missing}: pleatd serves a page that says so", file=sys.stderr)
    write_sources(folder, packed, out / "page_files.cpp")


if __name__ == "__main__":
    main()
