import ast
import json
import math
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import nbformat
import pytest

import robowidgets
from robowidgets.command import _lab, _notebooks, main

from ...conftest import ROOT


def one_line(capsys):
    """The error on stderr: one line, and nothing on stdout."""
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.endswith("\n")
    assert said.err.count("\n") == 1
    return said.err.strip()


@pytest.fixture
def lab(monkeypatch):
    """Record the arguments of JupyterLab instead of starting it."""
    started = []
    monkeypatch.setattr(_lab, "run", lambda *arguments, **_options: started.append(arguments[:3]))
    return started


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder to work in, removed with the test."""
    monkeypatch.chdir(tmp_path)


def test_doctor_prints_the_check_up_and_tells_by_its_exit_code_whether_there_are_problems(tmp_path, capsys):
    assert main(["doctor", str(robowidgets.SAMPLE)]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines()[1].split()[:3] == ["topic", "samples", "Hz"]
    assert said.out.endswith("no problems found\n")
    assert main(["doctor", "--json", str(robowidgets.SAMPLE)]) == 0
    assert json.loads(capsys.readouterr().out)["problems"] == []
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(robowidgets.SAMPLE.read_bytes()[:200_000])
    assert main(["doctor", str(cut)]) == 1
    assert "! the recording was cut off" in capsys.readouterr().out
    assert main(["doctor", str(tmp_path / "none.bag")]) == 2
    assert one_line(capsys).startswith("robowidgets: ")


def test_info_prints_the_table_of_a_recording(capsys):
    assert main(["info", str(robowidgets.SAMPLE)]) == 0
    said = capsys.readouterr()
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        assert said.out == recording.info() + "\n"
    assert "/bumper" in said.out
    assert said.err == ""


@pytest.mark.parametrize("command", ["info", "open"])
@pytest.mark.parametrize("what", ["missing", "empty", "foreign", "folder", "loop"])
def test_what_is_not_a_recording_is_one_line_and_1(command, what, tmp_path, capsys, lab):
    path = tmp_path / f"{what}.bag"
    if what == "folder":
        path.mkdir()
    elif what == "loop":
        path.symlink_to(path)
    elif what != "missing":
        path.write_bytes(b"" if what == "empty" else b"%PDF-1.7 something else" * 100)
    assert main([command, str(path)]) == 1
    line = one_line(capsys)
    assert line.startswith("robowidgets: ")
    assert path.name in line
    assert lab == []
    assert list(tmp_path.glob("robowidgets-*")) == []


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ([], "the following arguments are required: COMMAND"),
        (["fly"], "invalid choice: 'fly'"),
        (["info"], "the following arguments are required: FILE"),
        (["demo", "--port", "http"], "argument --port: expected a number from 0 to 65535, got 'http'"),
        (["demo", "--port", "65536"], "argument --port: expected a number from 0 to 65535, got '65536'"),
        (["demo", "--port=-1"], "argument --port: expected a number from 0 to 65535, got '-1'"),
        (["open", "a.bag", "b.bag"], "unrecognized arguments: b.bag"),
    ],
)
def test_arguments_that_make_no_sense_are_2(arguments, text, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert text in capsys.readouterr().err


def test_help_names_the_commands_and_what_they_take(capsys):
    for arguments, words in (
        (["--help"], ["demo", "open a tour", "info", "print the contents of a recording"]),
        (["demo", "--help"], ["--port", "127.0.0.1", "--no-browser"]),
        (["open", "--help"], ["FILE", ".mcap", "CARMEN", "--port", "--no-browser"]),
        (["info", "--help"], ["FILE", "rosbag2 folder", "--json"]),
        (
            ["find", "--help"],
            [
                "FILE",
                "--touched",
                "--nearest-below",
                "--speed-above",
                "--gap",
                "--silent TOPIC",
                "Exits with 0",
                "--json",
            ],
        ),
    ):
        with pytest.raises(SystemExit) as stopped:
            main(arguments)
        assert stopped.value.code == 0
        said = " ".join(capsys.readouterr().out.split())
        assert [word for word in words if word not in said] == []


@pytest.mark.slow
def test_python_m_robowidgets_is_the_same_command():
    run = [sys.executable, "-m", "robowidgets"]
    version = subprocess.run([*run, "--version"], capture_output=True, text=True, check=True)
    assert version.stdout == f"robowidgets {robowidgets.__version__}\n"
    failed = subprocess.run([*run, "info", "no such file"], capture_output=True, text=True, check=False)
    assert failed.returncode == 1
    assert failed.stderr == f"robowidgets: {Path.cwd() / 'no such file'}: no such file or folder\n"
    assert "Traceback" not in failed.stderr


def test_without_jupyterlab_it_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "jupyterlab", None)
    assert main(["demo"]) == 1
    assert one_line(capsys).endswith('type: pip install "robowidgets[lab]"')
    assert main(["open", str(robowidgets.SAMPLE)]) == 1
    assert one_line(capsys).endswith('type: pip install "robowidgets[lab]"')


def test_a_folder_that_cannot_be_written_to_is_one_line(tmp_path, capsys, lab):
    (tmp_path / "file").touch()
    assert main(["demo", "--folder", str(tmp_path / "file" / "notebooks")]) == 1
    assert str(tmp_path / "file") in one_line(capsys)
    assert lab == []


def test_the_demo_is_a_copy_of_the_tour_next_to_the_other_notebooks(lab, tmp_path, here):
    assert main(["demo", "--port", "0", "--no-browser"]) == 0
    ((tour, port, browser),) = lab
    assert (port, browser) == (0, False)
    assert tour.name == "tour.ipynb"
    assert tour.is_relative_to(tmp_path)
    assert tour.read_bytes() == (ROOT / "notebooks" / "tour.ipynb").read_bytes()
    assert {file.name for file in tour.parent.iterdir()} == {file.name for file in (ROOT / "notebooks").glob("*.ipynb")}


def test_a_notebook_that_the_user_changed_stays_where_it_was_and_as_it_was(lab, tmp_path, capsys, here):
    main(["demo"])
    tour = lab[0][0]
    assert tour.parent == tmp_path / "robowidgets-notebooks"
    assert f"Opening {tour} in JupyterLab. It is your copy: you can" in capsys.readouterr().out
    tour.write_text("mine")
    main(["demo"])
    assert tour.read_text() == "mine"

    same = tmp_path / "elsewhere" / robowidgets.SAMPLE.name
    same.parent.mkdir()
    shutil.copyfile(robowidgets.SAMPLE, same)
    for file in (robowidgets.SAMPLE, same, robowidgets.SAMPLE, same):
        main(["open", str(file)])
    assert [notebook.name for notebook, *_ in lab[2:]] == 2 * ["sample.ipynb", "sample-2.ipynb"]


def test_a_demo_opens_the_browser_at_a_port_of_jupyterlabs_choice(lab, here):
    main(["demo"])
    assert lab[0][1:] == (None, True)
    told = _lab.arguments(Path("/tmp/a folder/tour.ipynb"), None, True)
    assert not [argument for argument in told if "port" in argument or "browser" in argument]


def test_the_terminal_says_what_takes_the_time_and_what_went_wrong(monkeypatch, capsys, here):
    monkeypatch.setattr(_lab, "run", lambda *arguments, **_: arguments[-1]("A cell failed."))
    main(["demo"])
    opening, running, failed = capsys.readouterr().out.splitlines()
    assert "tour.ipynb in JupyterLab" in opening
    assert running.startswith("Running its cells first")
    assert failed == "A cell failed."


@pytest.mark.slow
@pytest.mark.versions
def test_open_writes_a_notebook_for_the_file(lab, here):
    assert main(["open", os.path.relpath(robowidgets.SAMPLE)]) == 0
    written = lab[0][0]
    assert written.name == "sample.ipynb"
    notebook = nbformat.read(written, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert [cell.source for cell in notebook.cells if cell.cell_type == "code"] == [
        f"import robowidgets\n\nrecording = robowidgets.open({str(robowidgets.SAMPLE)!r})\nrecording.show()",
        "recording",
    ]


@pytest.mark.parametrize(
    "name",
    [
        "it's.bag",
        '"); import os; ("',
        "back\\slash\\n",
        "two\nlines",
        "{braces} %s",
        "robot 🤖",
        "\udcff no text",
        "日本",
    ],
)
def test_a_path_of_any_characters_reaches_the_program_unchanged(name, tmp_path):
    written = _notebooks.write_for(Path("/a b") / name, tmp_path)
    assert written.parent == tmp_path
    source = json.loads(written.read_text("utf-8"))["cells"][1]["source"]
    _, opened, _ = ast.parse(source).body
    assert isinstance(opened, ast.Assign)
    assert isinstance(opened.value, ast.Call)
    assert ast.literal_eval(opened.value.args[0]) == f"/a b/{name}"


def test_notebooks_are_found_in_a_checkout_and_in_an_installed_package(monkeypatch, tmp_path):
    assert _notebooks.shipped() == ROOT / "notebooks"
    package = tmp_path / "site-packages" / "robowidgets"
    (package / "notebooks").mkdir(parents=True)
    (package / "notebooks" / "tour.ipynb").touch()
    monkeypatch.setattr(_notebooks, "_PACKAGE", package)
    assert _notebooks.shipped() == package / "notebooks"
    (package / "notebooks" / "tour.ipynb").unlink()
    with pytest.raises(FileNotFoundError, match="without its notebooks; install it again"):
        _notebooks.shipped()


@pytest.mark.slow
def test_jupyterlab_serves_the_notebook_already_run_on_this_machine_with_the_token(tmp_path):
    own = {name: str(tmp_path / name) for name in ("JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR")}
    environment = os.environ | own | {"JUPYTER_TOKEN": "guessed"}
    log = tmp_path / "log"
    with log.open("w") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "robowidgets", "demo", "--no-browser", "--port", "0"],
            env=environment,
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
        )
    try:
        server = json.loads(wait_for(tmp_path / "JUPYTER_RUNTIME_DIR" / f"jpserver-{process.pid}.json", process, log))
        assert server["url"].startswith("http://127.0.0.1:")
        assert len(server["token"]) >= 32
        assert Path(server["root_dir"]).parent == tmp_path
        cells = fetch(server, "api/contents/tour.ipynb", server["token"])["content"]["cells"]
        code = [cell for cell in cells if cell["cell_type"] == "code"]
        run = [cell for cell in code if cell["metadata"].get("tags") != ["live"]]
        assert [cell["execution_count"] for cell in run] == list(range(1, len(run) + 1))
        assert all(cell["metadata"]["trusted"] for cell in run)
        assert len(code) - len(run) == 1
        assert [session["path"] for session in fetch(server, "api/sessions", server["token"])] == ["tour.ipynb"]
        for token in ("", "guessed"):
            with pytest.raises(HTTPError, match="403"):
                fetch(server, "api/contents/tour.ipynb", token)
        assert f"lab/tree/tour.ipynb?token={server['token']}" in wait_for_text(log, server["token"], process)
    finally:
        process.terminate()
        process.wait()


def fetch(server, path, token):
    with urlopen(Request(f"{server['url']}{path}", headers={"Authorization": f"token {token}"}), timeout=240) as answer:
        return json.load(answer)


def wait_for(file, process, log):
    return wait_until(lambda: file.read_text() if file.exists() else "", "}", process, log)


def wait_for_text(log, text, process):
    return wait_until(log.read_text, text, process, log)


def wait_until(read, text, process, log):
    while text not in (got := read()):
        assert process.poll() is None, log.read_text()
        time.sleep(0.05)
    return got


def test_find_prints_spans_and_0(capsys):
    assert main(["find", str(robowidgets.SAMPLE), "--touched", "left", "--nearest-below", "0.3"]) == 0
    said = capsys.readouterr()
    head, *rows = said.out.splitlines()
    assert head == "# start\tend\tseconds\tnearest\tindex\tangle"
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        asked = robowidgets.conditions.touched("left") & robowidgets.conditions.nearest_below(0.3)
        spans = recording.find(asked)
    assert len(rows) > 1
    shown = [(*span[:3], span.nearest, span.index, math.degrees(span.angle)) for span in spans]
    assert [tuple(map(float, row.split("\t"))) for row in rows] == [pytest.approx(row, abs=5e-3) for row in shown]
    assert said.err == ""


def test_find_prints_json(capsys, monkeypatch):
    monkeypatch.setattr("robowidgets.notebook.progress.SHOWN_AFTER", 0)
    arguments = ["--speed-above", "0.1", "--gap", "1", "--any", "--speed", "/odom", "--json"]
    assert main(["find", str(robowidgets.SAMPLE), *arguments]) == 0
    said = capsys.readouterr()
    assert "Finding:   0%" in said.err, "progress goes to stderr"
    told = json.loads(said.out)
    assert told["condition"] == "(linear.x above 0.1 m/s | gap longer than 1 s)"
    assert told["complete"] is True
    assert {
        "start",
        "end",
        "seconds",
        "start_ns",
        "end_ns",
        "silent",
        "nearest",
        "index",
        "angle",
        "nearest_ns",
        "value",
        "value_ns",
    } == set(told["spans"][0])


def test_find_of_nothing_is_1(capsys):
    assert main(["find", str(robowidgets.SAMPLE), "--nearest-below", "0.3", "--sector", "3.1", "3.11"]) == 1
    assert capsys.readouterr().out == "# start\tend\tseconds\tnearest\tindex\tangle\n"


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["no.bag", "--touched"], "no.bag: no such file or folder"),
        ([str(robowidgets.SAMPLE)], "expected a condition: --touched, --nearest-below, --speed-above, --gap"),
        (
            [str(robowidgets.SAMPLE), "--touched", "nose"],
            "find: --touched: /bumper has no sensor 'nose'; it has 'left', 'center', 'right'",
        ),
        ([str(robowidgets.SAMPLE), "--gap=-1"], "find: --gap: expected a time above 0, got -1.0"),
        ([str(robowidgets.SAMPLE), "--nearest-below", "1", "--scan", "/scam"], "has no topic '/scam'"),
        ([str(robowidgets.SAMPLE), "--speed-above", "1", "--axis", "x"], "find: --axis: expected one of linear.x"),
    ],
)
def test_find_that_cannot_look_is_one_line_and_2(arguments, text, capsys):
    assert main(["find", *arguments]) == 2
    assert text in one_line(capsys)


def test_find_that_is_interrupted_prints_what_it_found(capsys, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("robowidgets.recordings.columns.speeds.Speeds.chunks", interrupted)
    assert main(["find", str(robowidgets.SAMPLE), "--speed-above", "0.1"]) == 130
    assert capsys.readouterr().out.splitlines()[-1] == "# stopped at 0.000: the rest was not searched"


def test_a_folder_for_notebooks_that_is_a_file_is_one_line(tmp_path, capsys):
    file = tmp_path / "drive.bag"
    file.touch()
    assert main(["demo", "--folder", str(file), "--no-browser"]) == 1
    assert f"--folder: {file} is a file; name a folder" in one_line(capsys)


def test_info_prints_json(capsys):
    assert main(["info", "--json", str(robowidgets.SAMPLE)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["seconds"] == pytest.approx(58)
    assert (told["topics"][0]["name"], told["topics"][0]["widget"]) == ("/scan", "laser")
    assert told["problems"] == []


@pytest.mark.slow
def test_export_writes_a_page_and_tells_its_size(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export", str(robowidgets.SAMPLE), "--size", "--end", "5"]) == 0
    assert re.fullmatch(r"sample\.html: about [12]\d\d kB\n", capsys.readouterr().out)
    assert main(["export", str(robowidgets.SAMPLE), "--every", "0"]) == 2
    assert one_line(capsys).startswith("robowidgets: --every: expected 1 for all scans")
    asked = [
        "export",
        str(robowidgets.SAMPLE),
        "--start",
        "10",
        "--end",
        "12",
        "--topic",
        "/odom",
        "--note",
        "It <turns>.",
    ]
    assert main([*asked, "-o", "bump.html"]) == 0
    written = tmp_path / "bump.html"
    assert capsys.readouterr().out == f"Wrote {written}: {written.stat().st_size / 1e3:.0f} kB\n"
    assert main([*asked, "-o", "bump.html", "--force", "--max-size", "inf"]) == 0
    text = written.read_text(encoding="utf-8")
    assert "It &lt;turns&gt;." in text
    assert "10.00 to 12.00 s of 58.00 s · 2025-06-15 15:06:50 UTC · /odom</p>" in text


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--start", "99"], "--start: expected seconds from 0 to 58.00, got 99"),
        (
            ["--max-size", "0.1"],
            "(--start, --end), fewer topics, or every second scan (--every 2), or allow more (--max-size",
        ),
        (["--max-size", "nan"], "expected --max-size above 0, got nan"),
        (["--max-size", "-1"], "expected --max-size above 0, got -1"),
        (["-o", "a.txt"], "expected a name that ends in .html or .htm"),
        (["-o", "there.html"], "there.html: already exists; replace it with --force, or name another with -o"),
        (["--topic", "/sacn"], "no topic '/sacn'"),
    ],
)
def test_export_that_cannot_be_is_one_line_and_2(arguments, text, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.html").write_text("there")
    assert main(["export", str(robowidgets.SAMPLE), *arguments]) == 2
    assert text in one_line(capsys)
    assert [file.name for file in tmp_path.iterdir()] == ["there.html"]
