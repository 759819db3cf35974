"""Memory measurements: the probes run in separate processes, whose memory is sampled from outside."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from .measure import OURS, Ratio, Row
from .probe import status

HERE = Path(__file__).parent
SAMPLE_SECONDS = 0.0005
PEAK_SECONDS = 0.005
#: Peak of a conversion in bytes, for a log of any size.
CONVERSION = 300e6


@dataclass(frozen=True, slots=True)
class Growth:
    """Memory growth of a process in bytes: at its peak, without mapped files, and the size of the columns."""

    peak: int
    anonymous: int
    columns: int


def first_message(library: str) -> tuple[float, float]:
    """Return seconds and bytes of importing a library and encoding a first message in a new interpreter."""
    name = library.rpartition(".")[2]
    # Installed packages include bytecode; for a source tree it is cached here.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(HERE / ".build" / "bytecode")
    command = [sys.executable, str(HERE / "probe_import.py"), name]
    result = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    seconds, size, _ = result.stdout.split()
    return float(seconds), float(size)


def growth(mode: str, library: str, warm: Path, path: Path) -> Growth:
    """Run a memory probe, and sample its anonymous memory while it works."""
    command = [sys.executable, "-m", "benchmarks.probe", mode, library, str(warm), str(path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=HERE.parent
    ) as child:
        send, receive = _pipes(child)
        before = int(json.loads(receive.readline())["anonymous"])
        finished, samples = threading.Event(), [before]
        watcher = threading.Thread(target=_watch, args=(child.pid, finished, samples))
        watcher.start()
        send.write("go\n")
        send.flush()
        answer = json.loads(receive.readline())
        finished.set()
        watcher.join()
    highest = max(*samples, int(answer["anonymous"]))
    return Growth(int(answer["peak"]), highest - before, int(answer["columns"]))


def _pipes(child: subprocess.Popen[str]) -> tuple[IO[str], IO[str]]:
    if child.stdin is None or child.stdout is None:
        raise RuntimeError("the probe has no pipes")
    return child.stdin, child.stdout


def _watch(process: int, finished: threading.Event, samples: list[int]) -> None:
    while not finished.wait(SAMPLE_SECONDS):
        try:
            samples.append(status(process)["RssAnon"])
        except (OSError, KeyError):
            return


def conversion(log: Path, target: Path) -> Row:
    """Measure the memory of a process that converts a log to Parquet: anonymous memory and mapped files."""
    shutil.rmtree(target, ignore_errors=True)
    words = [sys.executable, "-m", "mavstack", "data", "convert", str(log), "--to", "parquet"]
    process = subprocess.Popen([*words, "-o", str(target)], stdout=subprocess.DEVNULL)
    peak = 0  # of the program: the resource usage of a child begins with the memory of its parent
    while process.poll() is None:
        with suppress(OSError, KeyError):  # it has ended meanwhile
            peak = max(peak, status(process.pid)["VmHWM"])
        time.sleep(PEAK_SECONDS)
    if process.returncode:
        raise RuntimeError(f"the conversion ended with status {process.returncode}")
    name = f"memory of the conversion of a {log.suffix} of {log.stat().st_size / 1e6:.0f} MB"
    ratio = Ratio("of 300 MB", (peak / CONVERSION,), 1, higher_is_better=False)
    return Row(name, {OURS: f"{peak / 1e6:.0f} MB"}, (ratio,))
