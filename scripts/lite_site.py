"""Build JupyterLite with robowidgets as a folder for any web server: `lite_site.py OUT [NAME=FOLDER...]`.

It contains the notebooks of the package, with the lessons in all languages, the study, and the notebooks and modules of
each FOLDER below NAME. It accesses no registry: scripts/lite.sh fetches the packages into .venv-site. NumPy for the
browser is not in a registry. ROBOWIDGETS_PYODIDE_NUMPY names its file of Pyodide's distribution, or is `pyodide` to
fetch it from there. Its hash must match Pyodide's lock. Without NumPy, JupyterLite is built, but its notebooks fail at
the first import.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable
from email.parser import HeaderParser
from pathlib import Path
from typing import Any
from urllib.request import urlopen

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from robowidgets.notebook.in_browser import NO_SWITCHING

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv-site"
MODULES = ROOT / "tests" / "browser" / "node_modules"
PYODIDE = MODULES / "pyodide"
VERSION = json.loads((PYODIDE / "package.json").read_text(encoding="utf-8"))["version"]
KERNELS = ("pyodide.js", "pyodide.asm.js", "pyodide.asm.wasm", "python_stdlib.zip")
CORE = (*KERNELS, "pyodide.mjs")
KERNEL = VENV / "share" / "jupyter" / "labextensions" / "@jupyterlite" / "pyodide-kernel-extension" / "static" / "pypi"
DISTRIBUTION = "https://cdn.jsdelivr.net/pyodide/v{version}/full/{file}"
APPS = ("notebooks", "lab")
SHIPPED = ROOT / "notebooks"
STUDIES = ROOT / "studies"

IN_LITE = ROOT / "scripts" / "in_lite"
FZSTD = MODULES / "fzstd"
STAND_INS: dict[str, dict[str, Path]] = {
    "jedi": {},
    "sqlite3": {},
    "lz4": {
        "lz4/frame.py": IN_LITE / "lz4_frame.py",
        "lz4/_lz4.js": IN_LITE / "lz4.js",
        "lz4/_whole_frames.py": IN_LITE / "whole_frames.py",
    },
    "backports_zstd": {
        "backports/zstd.py": IN_LITE / "zstd.py",
        "backports/_fzstd.js": FZSTD / "umd" / "index.js",
        "backports/_whole_frames.py": IN_LITE / "whole_frames.py",
        "backports_zstd-0.0.0.dist-info/licenses/LICENSE": FZSTD / "LICENSE",
    },
}
"""Replacements for compiled dependencies of the kernel or a package, by name of the wheel. Recordings are unpacked by
JavaScript. The site saves the 5 MB of completions, and the database of the history."""

LEFT_OUT = frozenset({"apsw", "zstandard", "jupyterlab-widgets", "pexpect", "jedi"})
"""Dependencies that a browser does not have or need: databases, compression of recordings, a terminal."""

PRELOADED = ("micropip", "piplite", "sqlite3", "ipykernel", "comm", "pyodide_kernel", "jedi", "ipython", "robowidgets")
"""The packages to load first. The kernel compares these names with its names on PyPI, so `pyodide_kernel` has a `_`."""

NO_FILES = (
    "Python cannot read other files of this folder, and files that it writes are lost: this browser gives the page no "
    "service worker, as in a private window, or for an address that begins with http:// and is not localhost."
)

BROWSER = {"sys_platform": "emscripten", "platform_system": "Emscripten", "python_version": "3.13", "extra": ""}


def main() -> None:
    """Build JupyterLite into the folder of the command line."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("out", type=Path)
    given.add_argument("folders", nargs="*", metavar="NAME=FOLDER", help="notebooks to add, below a name")
    asked = given.parse_args()
    with tempfile.TemporaryDirectory() as place:
        lite = Path(place)
        write_core(lite / "static" / "pyodide")
        write_settings(lite)
        files = lite / "files"
        files.mkdir()
        for folder in ("", *(one.name for one in SHIPPED.iterdir() if one.is_dir())):
            for notebook in SHIPPED.glob("*.ipynb"):
                written = SHIPPED / folder / notebook.name  # in that language if it is translated
                copy_notebook(written if written.exists() else notebook, files / folder / notebook.name)
        for one in (f"{STUDIES.name}={STUDIES}", *asked.folders):
            name, _, source = one.partition("=")
            for notebook in Path(source).glob("*.ipynb"):
                copy_notebook(notebook, files / name / notebook.name)
            for module in Path(source).glob("*.py"):
                shutil.copy(module, files / name)
        subprocess.run(
            [VENV / "bin" / "jupyter", "lite", "build", "--lite-dir", lite, "--output-dir", lite / "out",
             "--no-sourcemaps", *(word for app in APPS for word in ("--apps", app)), "--no-unused-shared-packages"],
            cwd=lite, check=True, env=os.environ | {"PATH": f"{VENV / 'bin'}:{os.environ['PATH']}"},
        )  # fmt: skip
        add_start(lite / "out")
        shutil.rmtree(asked.out, ignore_errors=True)
        shutil.copytree(lite / "out", asked.out)
    check(asked.out / "static" / "pyodide")


def copy_notebook(source: Path, target: Path) -> None:
    """Copy a notebook with the browser's kernel, because JupyterLite would ask the user about another kernel."""
    notebook = json.loads(source.read_text(encoding="utf-8"))
    notebook["metadata"]["kernelspec"] = {"name": "python", "display_name": "Python (Pyodide)", "language": "python"}
    target.parent.mkdir(exist_ok=True)
    target.write_text(json.dumps(notebook), encoding="utf-8")


def write_core(to: Path) -> None:
    """Write Python for the browser, its packages, and the lock that lists them."""
    to.mkdir(parents=True)
    for name in CORE:
        shutil.copy(PYODIDE / name, to)
    found = [*(VENV / "wheels").glob("*.whl"), *KERNEL.glob("*.whl"), *map(stand_in, STAND_INS), own_wheel()]
    # The kernel has two wheels of widgetsnbextension, for ipywidgets 7 and 8.
    by_name = {canonicalize_name(wheel.name.split("-")[0]): wheel for wheel in sorted(found, key=lambda one: one.name)}
    lock = json.loads((PYODIDE / "pyodide-lock.json").read_text(encoding="utf-8"))
    numpy = numpy_of(lock)
    names = {*by_name, *(["numpy"] if numpy else [])}
    packages = {name: entry_of(wheel, names) for name, wheel in by_name.items()}
    for wheel in by_name.values():
        shutil.copy(wheel, to)
    if numpy:
        packages["numpy"] = lock["packages"]["numpy"] | {"depends": []}
        (to / packages["numpy"]["file_name"]).write_bytes(numpy)
    text = json.dumps({"info": lock["info"], "packages": dict(sorted(packages.items()))}, indent=1)
    (to / "pyodide-lock.json").write_text(text, encoding="utf-8")


def entry_of(wheel: Path, names: set[str]) -> dict[str, Any]:
    """Return the entry of a wheel in the lock, with the name and the dependencies from its metadata."""
    with zipfile.ZipFile(wheel) as archive:
        files = archive.namelist()
        metadata = next(name for name in files if name.endswith(".dist-info/METADATA"))
        about = HeaderParser().parsestr(archive.read(metadata).decode())
    needs = [Requirement(text) for text in about.get_all("Requires-Dist", [])]
    wanted = {canonicalize_name(need.name) for need in needs if need.marker is None or need.marker.evaluate(BROWSER)}
    if unknown := wanted - names - LEFT_OUT - {"numpy"}:
        raise SystemExit(f"{wheel.name} needs {', '.join(sorted(unknown))}: add it to scripts/lite-wheels.txt")
    modules = (name for name in files if name.endswith(".py") and ".dist-info/" not in name)
    return {
        "name": canonicalize_name(about["Name"]),
        "version": about["Version"],
        "file_name": wheel.name,
        "install_dir": "site",
        "sha256": hashlib.sha256(wheel.read_bytes()).hexdigest(),
        "package_type": "package",
        "imports": sorted({name.split("/")[0].removesuffix(".py") for name in modules}),
        "depends": sorted(wanted & names),
        "unvendored_tests": False,
    }


def own_wheel() -> Path:
    """Return the wheel of this checkout, with its built bundles."""
    to = VENV / "own"
    shutil.rmtree(to, ignore_errors=True)
    subprocess.run(
        [VENV / "bin" / "python", "-m", "build", "--wheel", "--no-isolation", "--skip-dependency-check", "-o", to],
        cwd=ROOT, check=True, stdout=subprocess.DEVNULL, env=os.environ | {"SKIP_JUPYTER_BUILDER": "1"},
    )  # fmt: skip
    return next(to.glob("*.whl"))


def stand_in(name: str) -> Path:
    """Return a wheel with our files, or without files, that replaces another wheel."""
    info, wheel = f"{name}-0.0.0.dist-info", VENV / f"{name}-0.0.0-py3-none-any.whl"
    texts = {
        **{file: source.read_text(encoding="utf-8") for file, source in STAND_INS[name].items()},
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.0.0\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: robowidgets\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, text in texts.items():
            archive.writestr(file, text)
        archive.writestr(f"{info}/RECORD", "".join(record(texts)) + f"{info}/RECORD,,\n")
    return wheel


def record(texts: dict[str, str]) -> Iterable[str]:
    """Yield the lines of a wheel's record."""
    for file, text in texts.items():
        data = text.encode()
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        yield f"{file},sha256={digest},{len(data)}\n"


def numpy_of(lock: dict[str, Any]) -> bytes:
    """Return NumPy for the browser, checked against Pyodide's lock, or nothing if it is not configured."""
    given, entry = os.environ.get("ROBOWIDGETS_PYODIDE_NUMPY", ""), lock["packages"]["numpy"]
    if not given:
        print(
            "Skipped: NumPy for the browser, so the site's notebooks fail at `import robowidgets`. "
            f"ROBOWIDGETS_PYODIDE_NUMPY={entry['file_name']} or =pyodide adds it."
        )
        return b""
    url = DISTRIBUTION.format(version=VERSION, file=entry["file_name"])
    try:
        if given == "pyodide":
            with urlopen(url, timeout=60) as came:
                numpy = bytes(came.read())
        else:
            numpy = Path(given).read_bytes()
    except OSError as error:
        raise SystemExit(
            f"ROBOWIDGETS_PYODIDE_NUMPY={given}: {error}. Name the file of {url}, or leave it out for a site "
            "without NumPy"
        ) from None
    found = hashlib.sha256(numpy).hexdigest()
    if found != entry["sha256"]:
        raise SystemExit(
            f"ROBOWIDGETS_PYODIDE_NUMPY: {given} is not the {entry['file_name']} that Pyodide "
            f"{VERSION} locks: its sha256 is {found}, expected {entry['sha256']}"
        )
    return numpy


def write_settings(lite: Path) -> None:
    """Write the settings with which the kernel loads Python and all packages only from the site."""
    lock = json.loads((lite / "static" / "pyodide" / "pyodide-lock.json").read_text(encoding="utf-8"))
    kernel = {
        "pyodideUrl": "./static/pyodide/pyodide.js",
        "disablePyPIFallback": True,
        "loadPyodideOptions": {"packages": [*PRELOADED, *({"numpy"} & lock["packages"].keys())]},
    }
    settings = {
        "jupyter-lite-schema-version": 0,
        "jupyter-config-data": {
            "appName": "robowidgets",
            "litePluginSettings": {"@jupyterlite/pyodide-kernel-extension:kernel": kernel},
        },
    }
    (lite / "jupyter-lite.json").write_text(json.dumps(settings, indent=1), encoding="utf-8")


def add_start(out: Path) -> None:
    """Add a start to each page of JupyterLite: the progress of loading Python, and missing features of the browser."""
    pyodide = out / "static" / "pyodide"
    packages = json.loads((pyodide / "pyodide-lock.json").read_text(encoding="utf-8"))["packages"]
    wanted, names = list(map(canonicalize_name, PRELOADED)), set[str]()
    while wanted:
        names.add(name := wanted.pop())
        wanted += [need for need in packages[name]["depends"] if need not in names]
    files = [*KERNELS, "pyodide-lock.json", *sorted(packages[name]["file_name"] for name in names)]
    sizes = {f"static/pyodide/{file}": (pyodide / file).stat().st_size for file in files}
    start = {"sizes": sizes, "words": {"noSwitching": f"{NO_SWITCHING}.", "noFiles": NO_FILES}}
    (out / "start.json").write_text(json.dumps(start, indent=1), encoding="utf-8")
    shutil.copy(IN_LITE / "start.js", out)
    for app in APPS:
        page, begin = out / app / "index.html", "await import("
        text = page.read_text(encoding="utf-8")
        if text.count(begin) != 1:
            raise SystemExit(f"{app}/index.html: expected to begin by one {begin!r}, got {text.count(begin)}")
        page.write_text(text.replace(begin, f"await import('../start.js');\n        {begin}"), encoding="utf-8")


_CHECK = """
const [folder, ...packages] = process.argv.slice(1);
process.on("uncaughtException", (error) => { console.error(String(error).slice(0, 1000)); process.exit(1); });
const { loadPyodide } = require(`${folder}/pyodide.js`);
loadPyodide({ indexURL: folder, packages }).then(
  (python) => python.runPython("import IPython, comm, ipywidgets, mcap.writer, micropip, traitlets, rosbags.rosbag1"),
);
"""


def check(folder: Path) -> None:
    """Load the packages of the kernel, because a name missing in the lock would leave a notebook without a message."""
    node = shutil.which("node", path=f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    ended = subprocess.run(
        [str(node), "-e", _CHECK, folder.resolve(), *PRELOADED],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=300, check=False,
    )  # fmt: skip
    if ended.returncode:
        raise SystemExit(f"the packages of the site do not load: {ended.stderr}")


if __name__ == "__main__":
    main()
