"""Fuzz target of the reader of Blackbox logs: any bytes after a flight's header are frames or counted.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["mavstack.logs.blackbox"]):
    from mavstack.errors import LogError
    from mavstack.logs.blackbox import BlackboxLog

from tests.logs.blackbox.writer import flight

FOLDER = Path(tempfile.mkdtemp())


def load(data: bytes) -> None:
    """Open one file, decode all its tables, and ask for its facts."""
    path = FOLDER / "fuzz.bbl"
    path.write_bytes(data)
    try:
        log = BlackboxLog(path)
        tables = dict(log.items())
    except LogError:
        return
    assert {name: len(table) for name, table in tables.items()} == log.counts
    assert log.skipped.bad_bytes <= len(data)
    assert all(record.name in log for record in log.records())
    assert log.duration >= 0
    assert log.skipped.describe()
    assert len(log.texts) + len(log.parameter_changes) <= len(data)
    assert len(log.info) + len(log.parameters) <= len(data)


if __name__ == "__main__":
    corpus = Path(tempfile.mkdtemp())
    for seed in range(3):
        (corpus / f"flight-{seed}").write_bytes(flight(seed, 12).data)
    atheris.Setup([*sys.argv, str(corpus)], load)
    atheris.Fuzz()
