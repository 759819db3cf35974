"""The start of `mav`: Ctrl-C during its imports ends it without a traceback."""

from __future__ import annotations

import gc
import sys
from typing import Final

from mavstack.cli.common.interrupted_imports import ended_by_sigint

#: A module that reports its objects as leaks if they exist at the exit of the process.
_CHECKS_AT_EXIT: Final = "duckdb"


def main() -> int:
    """Run `mav` with the words of the process.

    Returns:
        The exit code.
    """
    with ended_by_sigint():
        from mavstack.cli.main import main as run
    code = run()
    if _CHECKS_AT_EXIT not in sys.modules:
        # The garbage collections at exit would search all objects, which the system frees together.
        gc.freeze()
    return code
