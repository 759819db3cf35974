"""Ctrl-C during imports leaves no traceback."""

from __future__ import annotations

import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from mavstack.cli.common.interrupted_imports import ended_by_sigint
from tests.interrupts import keyboard_interrupts

#: Interrupts itself in a class body, as a user does in the middle of an import.
MODULE = """
import os, signal
class Field:
    def __set_name__(self, owner, name):
        os.kill(os.getpid(), signal.SIGINT)
class Message:
    field = Field()
"""
PROGRAM = """
from mavstack.cli.common.interrupted_imports import ended_by_sigint
with ended_by_sigint():
    import interrupted
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_ctrl_c_during_an_import_leaves_no_traceback(tmp_path):
    (tmp_path / "interrupted.py").write_text(MODULE)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60
    )
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")


def test_the_handler_is_back_after_the_imports():
    before = signal.getsignal(signal.SIGINT)
    with ended_by_sigint():
        pass
    assert signal.getsignal(signal.SIGINT) is before


def test_a_handler_of_the_program_stays():
    def handler(*_: object) -> None: ...

    before = signal.signal(signal.SIGINT, handler)
    try:
        with ended_by_sigint():
            assert signal.getsignal(signal.SIGINT) is handler
        assert signal.getsignal(signal.SIGINT) is handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_thread_that_cannot_set_handlers_imports_too():
    def import_in_thread() -> str:
        with ended_by_sigint():
            return "imported"

    with keyboard_interrupts(), ThreadPoolExecutor(1) as pool:
        assert pool.submit(import_in_thread).result() == "imported"
