"""The core works in the main interpreter of a process only, and sub-interpreters are told so."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys

import pytest

#: Imports the core in a sub-interpreter, then in the main one, and prints what either says.
PROGRAM = """
import {module} as interpreters
number = interpreters.create()
text = '''
try:
    import mavstack.wire
except ImportError as error:
    print("sub:", error, flush=True)
else:
    print("sub: imported", flush=True)
'''
interpreters.run_string(number, text)
interpreters.run_string(number, text)
interpreters.destroy(number)
from mavstack.wire import crc16
print("main:", crc16(b"123456789"))
"""


def interpreters_module() -> str:
    """Return the module of this Python that makes sub-interpreters."""
    for name in ("_interpreters", "_xxsubinterpreters"):
        if importlib.util.find_spec(name):
            return name
    pytest.skip("this Python makes no sub-interpreters")


def test_a_sub_interpreter_is_refused_in_one_line_and_the_main_one_works():
    program = PROGRAM.format(module=interpreters_module())
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    *refusals, main = ended.stdout.splitlines()
    assert len(refusals) == 2
    for refusal in refusals:
        # From Python 3.12 on isolated sub-interpreters refuse modules that do not declare to work there.
        assert re.fullmatch(
            "sub: (importing mavstack failed: this is sub-interpreter [0-9]+, .*main interpreter only.*"
            "|module mavstack._core does not support loading in subinterpreters)",
            refusal,
        )
    assert main == f"main: {0x6F91}"
