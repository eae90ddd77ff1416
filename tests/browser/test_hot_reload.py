"""The developer's loop: a rebuilt front end appears in the open notebook."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import expect

from ..conftest import ROOT
from .notebook import Notebook


def test_a_new_bundle_replaces_the_one_on_show(notebook: Callable[..., Notebook], tmp_path: Path) -> None:
    copy = shutil.copytree(
        ROOT / "robowidgets", tmp_path / "robowidgets", ignore=shutil.ignore_patterns("js", "__pycache__")
    )
    develop = "os.environ.update(ROBOWIDGETS_DEV='1', ANYWIDGET_HMR='1')"
    nb = notebook(
        [
            f"import os, sys\nsys.path.insert(0, {str(tmp_path)!r})\n{develop}",
            "import robowidgets\nrobowidgets.LaserWidget()",
        ]
    )
    expect(nb.widget(1).locator(".rw-card")).to_be_visible()
    (copy / "static" / "laser_widget.js").write_text("export default { render({ el }) { el.textContent = 'anew'; } };")
    expect(nb.widget(1)).to_have_text("anew")
