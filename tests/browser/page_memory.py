"""The memory of a page after garbage collection."""

from __future__ import annotations

from dataclasses import dataclass

from playwright.sync_api import Page

COUNT_DETACHED = "function () { return this.filter((canvas) => !canvas.isConnected).length }"


@dataclass(frozen=True)
class Kept:
    """Counts of a page, and of JupyterLab in it."""

    nodes: int
    listeners: int
    heap: int
    """Bytes."""
    detached_canvases: int
    """Canvases outside the document that JavaScript can reach."""


class PageMemory:
    """Counts the objects of a page with Chromium's own tools."""

    def __init__(self, page: Page) -> None:
        self._tools = page.context.new_cdp_session(page)
        self._tools.send("Performance.enable")
        self._tools.send("HeapProfiler.enable")

    def kept(self) -> Kept:
        """Collect garbage, and count the rest."""
        for _ in range(3):  # what finalizers release is garbage of the next collection
            self._tools.send("HeapProfiler.collectGarbage")
        counts = {entry["name"]: int(entry["value"]) for entry in self._tools.send("Performance.getMetrics")["metrics"]}
        prototype = self._tools.send(
            "Runtime.evaluate", {"expression": "HTMLCanvasElement.prototype", "objectGroup": "counted"}
        )
        canvases = self._tools.send(
            "Runtime.queryObjects",
            {"prototypeObjectId": prototype["result"]["objectId"], "objectGroup": "counted"},
        )
        detached = self._tools.send(
            "Runtime.callFunctionOn",
            {
                "objectId": canvases["objects"]["objectId"],
                "functionDeclaration": COUNT_DETACHED,
                "returnByValue": True,
            },
        )
        self._tools.send("Runtime.releaseObjectGroup", {"objectGroup": "counted"})
        return Kept(
            nodes=counts["Nodes"],
            listeners=counts["JSEventListeners"],
            heap=counts["JSHeapUsedSize"],
            detached_canvases=detached["result"]["value"],
        )
