"""S9: a kill or a full disk in the middle of a write must not leave a truncated file.

The limit on file sizes of the operating system stops each writer in the middle: with an error, like a full
disk, or by a signal that kills the process.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

resource = pytest.importorskip("resource")

LIMIT = 2048
#: A dialect without messages; for the other writers any text.
GOOD = "<mavlink></mavlink>"
SETUP = f"""
import resource, signal, sys
signal.signal(signal.SIGXFSZ, getattr(signal, sys.argv[2]))
resource.setrlimit(resource.RLIMIT_FSIZE, ({LIMIT}, {LIMIT}))
target = sys.argv[1]
"""
PLAN = """
from mavstack.files.plans import PlanFile, write_plan
from mavstack.services.mission import MissionItem
items = [MissionItem(16, param5=1.0, param6=1.0, param7=float(n)) for n in range(200)]
write_plan(target, PlanFile.of(items), "waypoints")
"""
CONVERT = """
from mavstack.cli.main import main
lines = ["QGC WPL 110"] + [f"{n}\\t0\\t3\\t16\\t0\\t0\\t0\\t0\\t1.0\\t1.0\\t9\\t1" for n in range(200)]
import io
sys.stdin = io.TextIOWrapper(io.BytesIO("\\n".join(lines).encode()))
sys.exit(main(["mission", "convert", "--force", "-", target, "--format", "waypoints"]))
"""
PARAMETERS = """
from mavstack.files.parameters import FORMATS, ParameterFile, StoredParameter, write_parameters
parameters = tuple(StoredParameter(f"P{n}", n) for n in range(400))
write_parameters(target, ParameterFile(parameters), next(iter(FORMATS)))
"""
DIALECT = """
from pathlib import Path
import mavstack.dialects as home
from mavstack.dialects.importer import import_file
import_file(str(Path(home.__file__).parent / "definitions" / "minimal.xml"), target)
"""


@pytest.mark.parametrize("reaction", ["SIG_IGN", "SIG_DFL"])
@pytest.mark.parametrize(
    "writer", [PLAN, CONVERT, PARAMETERS, DIALECT], ids=["plan", "convert", "param", "dialect"]
)
def test_an_interrupted_writer_leaves_the_good_file(tmp_path, writer: str, reaction: str) -> None:
    target = tmp_path / "target.xml"
    target.write_text(GOOD)
    run = subprocess.run(
        [sys.executable, "-c", SETUP + writer, str(target), reaction],
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert run.returncode != 0, run.stderr.decode()
    assert target.read_text() == GOOD, run.stderr.decode()
    if reaction == "SIG_IGN":
        assert b"File too large" in run.stderr, run.stderr.decode()
        assert [item.name for item in tmp_path.iterdir()] == ["target.xml"]
