"""The package that pip installs: built from sources outside git, on a machine without Node."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from zipfile import ZipFile

import pytest

from .conftest import ROOT

WIDGETS = sorted(file.stem for file in (ROOT / "robowidgets" / "js").glob("*_widget.ts"))
PAGES = sorted(file.stem for file in (ROOT / "robowidgets" / "js").glob("export_*.ts"))
"""The scripts of pages that play without a kernel."""
EACH = "run_once.js"
"""The files that Jupyter runs for each widget."""
FRONT_END = {EACH, "later.js"} | {f"{name}.{kind}" for name in (*WIDGETS, *PAGES) for kind in ("js", "css")}
LARGEST_SAMPLE = 1_000_000
RECORDINGS = (".bag", ".mcap", ".db3")
# Addresses that are never fetched: names of XML namespaces, and the address in the licence of uPlot.
NAMES = re.compile(r"https?://(www\.w3\.org/|github\.com/leeoniya/uPlot\b)")
SOURCES = (".ts", ".mjs", "package.json", "package-lock.json", "tsconfig.json", "biome.json")


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An sdist, and the wheel that is built from it."""
    folder = tmp_path_factory.mktemp("dist")
    source = folder / "source"
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    for name in subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0"):
        if name and (ROOT / name).is_file():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, source / name)
    tools = folder / "bin"
    tools.mkdir()
    for name in ("env", "sh"):
        (tools / name).symlink_to(shutil.which(name) or name)
    assert shutil.which("node", path=str(tools)) is None
    command = [sys.executable, "-m", "build", "--outdir", folder / "dist", source]
    built = subprocess.run(command, env=os.environ | {"PATH": str(tools)}, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout[-4000:] + built.stderr[-4000:]
    return folder / "dist"


@pytest.fixture(scope="module")
def installed(dist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that holds the wheel, unpacked by pip."""
    folder = tmp_path_factory.mktemp("site")
    wheel = next(dist.glob("*.whl"))
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", folder, wheel],
        check=True,
    )
    return folder


@pytest.fixture(scope="module")
def package(installed: Path) -> Path:
    return installed / "robowidgets"


def samples(package: Path) -> list[Path]:
    return [file for file in package.rglob("*") if file.suffix in RECORDINGS]


def test_the_wheel_holds_the_widgets_front_end(package: Path) -> None:
    for name in WIDGETS:
        assert "export" in (package / "static" / f"{name}.js").read_text()
        assert ".rw-" in (package / "static" / f"{name}.css").read_text()
    assert {file.name for file in (package / "static").iterdir()} == FRONT_END


def test_the_front_end_asks_the_web_for_nothing(package: Path) -> None:
    for file in (package / "static").iterdir():
        text = NAMES.sub("", file.read_text())
        assert not re.findall(r"https?://[^\s\"']*", text), f"an address in {file.name}"
        # The script of a widget comes with the widget, and is run from memory.
        loads = r"@import|(?<!\")\bfrom\s*\"[^\"]" + ("" if file.name == EACH else r"|\bimport\s*\(")
        assert not re.search(loads, text), f"{file.name} loads another file"


def test_the_wheel_holds_types_definitions_notebooks_and_one_small_recording(package: Path) -> None:
    assert (package / "py.typed").is_file()
    for name in ("kobuki_msgs", "create_msgs", "irobot_create_msgs", "turtlebot3_msgs", "gazebo_msgs"):
        assert (package / "messages" / "definitions" / f"{name}.txt").is_file(), f"no definitions of {name}"
    shipped, ours = package / "notebooks", ROOT / "notebooks"
    assert {file.relative_to(shipped) for file in shipped.glob("**/*.ipynb")} == {
        file.relative_to(ours) for file in ours.glob("**/*.ipynb") if "checkpoints" not in str(file)
    }
    assert {file.name for file in (package / "lessons" / "texts").glob("*.mo")} == {"de.mo", "es.mo"}
    (sample,) = samples(package)
    assert sample.stat().st_size <= LARGEST_SAMPLE


def test_the_wheel_holds_nothing_but_the_package(dist: Path) -> None:
    names = ZipFile(next(dist.glob("*.whl"))).namelist()
    foreign = [name for name in names if not name.startswith(("robowidgets/", "robowidgets-"))]
    leftovers = [name for name in names if "node_modules" in name or name.endswith(SOURCES)]
    assert (foreign, leftovers) == ([], [])


def test_the_sdist_holds_the_sources_of_the_front_end_but_not_its_tools(dist: Path) -> None:
    with tarfile.open(next(dist.glob("*.tar.gz"))) as archive:
        names = archive.getnames()
    assert [name for name in names if name.endswith("robowidgets/js/laser_widget.ts")]
    assert not [name for name in names if "node_modules" in name]


def test_an_installed_wheel_reads_its_own_recording(installed: Path, package: Path, tmp_path: Path) -> None:
    (sample,) = samples(package)
    run = subprocess.run(
        [sys.executable, "-m", "robowidgets", "info", sample],
        env=os.environ | {"PYTHONPATH": str(installed)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "sensor_msgs/msg/LaserScan" in run.stdout
    where = [sys.executable, "-c", "import robowidgets; print(robowidgets.__file__)"]
    imported = subprocess.run(
        where, env=os.environ | {"PYTHONPATH": str(installed)}, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert Path(imported.stdout.strip()).is_relative_to(installed)
