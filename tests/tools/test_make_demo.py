"""`make demo` ends quietly at Ctrl-C."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys

import pytest

from tests.docs.blocks import ROOT

DEMO = """\
#!/bin/sh
trap 'kill $child; exit 130' INT
sleep 60 &
child=$!
echo flying
wait
"""


@pytest.mark.skipif(sys.platform == "win32" or not shutil.which("make"), reason="needs make")
def test_ctrl_c_is_no_error_of_make(tmp_path):
    program = tmp_path / "mav"
    program.write_text(DEMO)
    program.chmod(0o755)
    package = tmp_path / "package"
    package.touch()
    words = [
        "make",
        "--no-print-directory",
        f"--old-file={package}",
        "demo",
        f"BIN={tmp_path}",
        f"VENV={tmp_path}",
    ]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    pipe = subprocess.PIPE
    with subprocess.Popen(
        words, cwd=ROOT, stdout=pipe, stderr=pipe, text=True, env=environment, start_new_session=True
    ) as running:
        assert running.stdout is not None
        assert running.stderr is not None
        assert running.stdout.readline() == "flying\n"
        os.killpg(running.pid, signal.SIGINT)
        assert (running.stdout.read(), running.stderr.read()) == ("", "")
