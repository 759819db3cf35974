"""ULog passes the conformance tests of logs."""

from __future__ import annotations

from tests.logs.conformance import LogConformance
from tests.logs.ulog.ulog_files import flight


class TestUlog(LogConformance):
    format = "ulog"

    def write(self, folder):
        path = folder / "flight"
        path.write_bytes(flight(400))
        return path
