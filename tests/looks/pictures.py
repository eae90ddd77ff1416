"""Small pictures of the looks, for the eye: light and wide, next to dark and narrow. No test compares them."""

from __future__ import annotations

import io
import json
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Page, sync_playwright

from robowidgets.widget.front_end import STATIC

from ..browser.chromium import launch
from ..conftest import ROOT
from ..node import ENVIRONMENT
from . import Look, encode

_SIZES = {"light": 440, "dark": 240}
_COLORS = 32
_SCALE = 0.7
_MODEL = f"""
const {{ stripTypeScriptTypes }} = require("node:module");
const text = require("node:fs").readFileSync({str(ROOT / "tests" / "js" / "models.ts")!r}, "utf8");
process.stdout.write(stripTypeScriptTypes(text));
"""
_SHOW = """
async ({script, style, traits, theme, model}) => {
  const load = (text) => import(URL.createObjectURL(new Blob([text], {type: "text/javascript"})));
  const revive = (_, value) => value?.base64 === undefined ? value
    : new DataView(Uint8Array.from(atob(value.base64), (letter) => letter.charCodeAt(0)).buffer);
  const {FakeModel} = await load(model);
  const {default: make} = await load(script);
  document.body.dataset.theme = theme;
  document.body.style.cssText = `margin: 0; background: ${theme === "dark" ? "#111418" : "#fff"}`;
  document.head.append(Object.assign(document.createElement("style"), {textContent: style}));
  const el = document.body.appendChild(document.createElement("div"));
  const widget = typeof make === "function" ? make() : make;
  const given = {model: new FakeModel(JSON.parse(traits, revive)).model, el, signal: new AbortController().signal};
  await widget.initialize?.(given);
  await widget.render(given);
}
"""


def write(looks: Mapping[str, Look], files: Iterable[Path]) -> None:
    """Write the pictures of looks into files."""
    stripped = subprocess.run(
        ["node", "--no-warnings", "-e", _MODEL], env=ENVIRONMENT, capture_output=True, encoding="utf-8", check=True
    )
    with sync_playwright() as playwright:
        browser = launch(playwright)
        for look, file in zip(looks.values(), files, strict=True):
            shots = []
            for theme, width in _SIZES.items():
                page = browser.new_page(viewport={"width": width, "height": 480}, device_scale_factor=_SCALE)
                shots.append(_shot(page, look, theme, stripped.stdout))
                page.close()
            _beside(shots).quantize(_COLORS, Image.Quantize.MAXCOVERAGE).save(file, optimize=True)
        browser.close()


def _shot(page: Page, look: Look, theme: str, model: str) -> Image.Image:
    script, traits = look.state()
    front_end = {kind: (STATIC / f"{script}.{ending}").read_text("utf-8") for kind, ending in _FILES.items()}
    state = json.dumps(traits, default=encode)
    page.evaluate(_SHOW, {**front_end, "traits": state, "theme": theme, "model": model})
    page.wait_for_timeout(400)
    for step in look.steps:
        _act(page, step)
    return Image.open(io.BytesIO(page.locator("body > div").screenshot(animations="disabled"))).convert("RGB")


_FILES = {"script": "js", "style": "css"}


def _act(page: Page, step: Mapping[str, Any]) -> None:
    if step.get("event") == "click":
        page.locator(step["on"]).first.click()
    elif step.get("event") == "pointermove":
        x, y = step["at"]
        page.locator(".rw-picture").hover(position={"x": x, "y": y})
    elif step.get("event") == "keydown":
        page.locator(".rw-picture").press(step["key"])
    page.wait_for_timeout(step.get("pass", 300))


def _beside(shots: list[Image.Image]) -> Image.Image:
    whole = Image.new("RGB", (sum(shot.width for shot in shots), max(shot.height for shot in shots)), "white")
    left = 0
    for shot in shots:
        whole.paste(shot, (left, 0))
        left += shot.width
    return whole
