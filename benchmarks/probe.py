"""Memory at its peak, in a process of its own.

    python -m benchmarks.probe columns mavstack|pymavlink WARM.tlog FLIGHT.tlog
    python -m benchmarks.probe stream mavstack WARM.tlog FLIGHT.tlog

The work is done once on a small log first, so that what is imported and made once is no growth. Growth
is what the kernel says of this process: the peak of its resident set (`VmHWM`, reset before the work)
less what was resident before. That counts pages of a mapped file, which the kernel drops whenever it
wants them back; `RssAnon`, memory without a file behind it, does not, but has no peak in the kernel, so
the parent samples it: the probe prints a line when it is ready and waits for one before it starts.
Prints JSON, a line each time.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

CHUNK = 1 << 20


def status(process: int | str = "self") -> dict[str, int]:
    """The memory lines of /proc/PID/status, in bytes."""
    lines = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace").splitlines()
    pairs = (line.split(":", 1) for line in lines if line.endswith(" kB"))
    return {name: int(value.split()[0]) * 1024 for name, value in pairs}


def _reset_peak() -> None:
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError as problem:
        print(f"the peak cannot be reset: {problem}", file=sys.stderr)


class Work:
    """One piece of work on a log; it keeps what it made until the process ends."""

    def __init__(self, what: str, who: str) -> None:
        self.kept: object = None
        self.size = 0
        self._run = self._stream if what == "stream" else self._ours if who == "mavstack" else self._theirs

    def __call__(self, path: Path) -> int:
        """Do it; the bytes of columns made."""
        self.kept = None
        return self._run(path)

    def _ours(self, path: Path) -> int:
        from . import ours

        self.kept = tables = ours.columns(path)
        return sum(table.nbytes for table in tables.values())

    def _theirs(self, path: Path) -> int:
        from . import peers_pymavlink

        self.kept = tables = peers_pymavlink.columns(path)
        return sum(column.nbytes for table in tables.values() for column in table.values())

    def _stream(self, path: Path) -> int:
        from . import ours

        ours.stream(path, CHUNK)
        return 0


def main(what: str, who: str, warm: str, flight: str) -> None:
    """Warm up, say so, wait, work, tell."""
    work = Work(what, who)
    work(Path(warm))
    _reset_peak()
    before = status()
    print(json.dumps({"anonymous": before["RssAnon"]}), flush=True)
    sys.stdin.readline()
    size = work(Path(flight))
    after = status()
    told = {"peak": after["VmHWM"] - before["VmRSS"], "anonymous": after["RssAnon"], "columns": size}
    print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
