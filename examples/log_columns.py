"""Read a log as numpy tables: the messages and their fields, and the range of the altitude."""

from pathlib import Path

import numpy as np

import mavstack

log = mavstack.open_log(Path(__file__).parents[1] / "tests" / "recordings" / "flight.tlog")
print(f"{sum(log.counts.values())} rows in {log.duration:.1f} s, {log.skipped.describe()}")

for name in log:
    table = log[name]
    print(f"{name:24} {len(table):5} rows, fields {', '.join((table.dtype.names or ())[5:8])} …")

if "GLOBAL_POSITION_INT" in log:
    altitude = log["GLOBAL_POSITION_INT"]["relative_alt"] / 1000
    print(f"altitude {np.min(altitude):.1f} … {np.max(altitude):.1f} m above home")
