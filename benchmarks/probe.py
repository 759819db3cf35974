"""Peak memory of decoding a log, in a separate process.

    python -m benchmarks.probe columns mavstack|pymavlink WARM.tlog FLIGHT.tlog
    python -m benchmarks.probe stream mavstack WARM.tlog FLIGHT.tlog

A small log is decoded first, so that imports and caches do not count as growth. The growth is the peak of the
resident set (`VmHWM`, reset before the work) minus the resident set before. It includes pages of the mapped
file, which the kernel can reclaim at any time; `RssAnon`, memory without a file behind it, excludes them, but
the kernel records no peak of it, so the parent process samples it: the probe prints a line when it is ready
and waits for a line before it starts. Each output line is JSON.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

CHUNK = 1 << 20


def status(process: int | str = "self") -> dict[str, int]:
    """Return the memory values of /proc/PID/status in bytes."""
    lines = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace").splitlines()
    pairs = (line.split(":", 1) for line in lines if line.endswith(" kB"))
    return {name: int(value.split()[0]) * 1024 for name, value in pairs}


def _reset_peak() -> None:
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError as problem:
        print(f"the peak cannot be reset: {problem}", file=sys.stderr)


class Work:
    """One benchmark on a log, which keeps its result until the process ends."""

    def __init__(self, mode: str, library: str) -> None:
        self.result: object = None
        self.size = 0
        self._run = (
            self._stream if mode == "stream" else self._ours if library == "mavstack" else self._theirs
        )

    def __call__(self, path: Path) -> int:
        """Run the benchmark; return the size of the columns in bytes."""
        self.result = None
        return self._run(path)

    def _ours(self, path: Path) -> int:
        from . import ours

        self.result = tables = ours.columns(path)
        return sum(table.nbytes for table in tables.values())

    def _theirs(self, path: Path) -> int:
        from . import peers_pymavlink

        self.result = tables = peers_pymavlink.columns(path)
        return sum(column.nbytes for table in tables.values() for column in table.values())

    def _stream(self, path: Path) -> int:
        from . import ours

        ours.stream(path, CHUNK)
        return 0


def main(mode: str, library: str, warm: str, flight: str) -> None:
    """Warm up, report ready, wait, run the benchmark, and print the growth."""
    work = Work(mode, library)
    work(Path(warm))
    _reset_peak()
    before = status()
    print(json.dumps({"anonymous": before["RssAnon"]}), flush=True)
    sys.stdin.readline()
    size = work(Path(flight))
    after = status()
    output = {"peak": after["VmHWM"] - before["VmRSS"], "anonymous": after["RssAnon"], "columns": size}
    print(json.dumps(output), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
