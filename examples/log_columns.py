"""Read a log as numpy tables: how high and how fast did it fly?"""

from pathlib import Path

import numpy as np

import mavstack

log = mavstack.open_log(Path(__file__).parents[1] / "tests" / "recordings" / "flight.tlog")
print(f"{log.statistics.packets} packets in {log.duration:.1f} s, {log.statistics.bad_bytes} bytes of junk")

for name in log:
    table = log[name]
    print(f"{name:24} {len(table):5} rows, fields {', '.join((table.dtype.names or ())[5:8])} …")

if "GLOBAL_POSITION_INT" in log:
    height = log["GLOBAL_POSITION_INT"]["relative_alt"] / 1000
    print(f"height {np.min(height):.1f} … {np.max(height):.1f} m")
