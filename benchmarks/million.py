"""An index of a thousand drives and, by repetition, of a million: to open it, to find by it, and its memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyarrow as arrow
import pyarrow.compute as compute
import pyarrow.parquet as parquet

import robowidgets
from robowidgets.notebook.progress import without_bars

from .drives import DIFFERENT, simulated

COUNT = 1000
"""The number of recordings, and how often each is in the large index."""
_NOISE = 0.3
"""The greatest number that is added to each value, so that repeated rows are not smaller than different ones."""

_MEASURE = """
import json, resource, sys, time
import robowidgets
from robowidgets import conditions

drives = None
found = {}

def step(name, work):
    began, used = time.perf_counter(), time.process_time()
    result = work()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    found[name] = time.perf_counter() - began, time.process_time() - used, peak
    return result

rare = conditions.nearest_below(0.02, "front") & conditions.speed_above(0.1)
drives = step("open and print", lambda: (one := robowidgets.drives(sys.argv[1]), repr(one))[0])
step("candidates, no recording looked at", lambda: drives.candidates(rare, check=False))
step("the same again", lambda: drives.candidates(rare, check=False))
step("candidates, each recording looked at", lambda: drives.candidates(rare))
step("find, no recording looked at", lambda: repr(drives.find(rare, check=False)))
step("compare with itself", lambda: repr(drives.compare(drives, rare, check=False)))
print(json.dumps(found))
"""


def compare(count: int = COUNT) -> None:
    """Print what both indexes cost."""
    with tempfile.TemporaryDirectory() as folder, without_bars():
        root = Path(folder)
        runs = root / "runs"
        runs.mkdir()
        different = [simulated(runs / f"drive_{i:04}", i).read_bytes() for i in range(DIFFERENT)]
        for i in range(DIFFERENT, count):
            (runs / f"drive_{i:04}.mcap").write_bytes(different[i % DIFFERENT])
        small = robowidgets.index(runs, output=root / "small.parquet").path
        large = root / "large.parquet"
        repeat(small, runs, root / "many", large, count)
        for path in (small, large):
            drives = robowidgets.drives(path)
            print(
                f"\n{len(drives):,} drives, {drives.dataset.count_rows():,} rows, {path.stat().st_size / 1e6:,.1f} MB\n"
            )
            print("| step | s | s of CPU | MB at most so far |\n| --- | --- | --- | --- |")
            out = subprocess.run([sys.executable, "-c", _MEASURE, path], check=True, capture_output=True, text=True)
            for step, (seconds, cpu, peak) in json.loads(out.stdout).items():
                print(f"| {step} | {seconds:.2f} | {cpu:.2f} | {peak:,.0f} |", flush=True)


def repeat(small: Path, runs: Path, many: Path, large: Path, times: int) -> None:
    """Write an index with the rows of another several times, each time in another folder: a link to the recordings."""
    rows = parquet.read_table(small)
    random = np.random.default_rng(1)
    many.mkdir()
    with parquet.ParquetWriter(large, rows.schema, compression="zstd") as writer:
        for i in range(times):
            folder = many / f"{i:06}"
            folder.symlink_to(runs)
            columns = {}
            for name in rows.schema.names:
                column = rows[name]
                if name in ("file", "state"):
                    column = compute.replace_substring(column, str(runs), str(folder))
                elif arrow.types.is_floating(column.type) and name != "gap":
                    values = column.to_numpy()
                    noise = random.random(len(values)).astype(values.dtype)
                    column = arrow.array(values + values.dtype.type(_NOISE) * noise, column.type, from_pandas=True)
                columns[name] = column
            writer.write_table(arrow.table(columns, schema=rows.schema))
