"""The memory of tables that are decoded together."""

from __future__ import annotations

import numpy as np

from mavstack.logs.table_memory import new_tables

ROW = np.dtype([("a", "<i8"), ("b", "<f4")])


def test_small_tables_share_blocks_and_do_not_overlap():
    counts = [1000, 0, 200_000, 5, 600_000, 300_000, *[150_000] * 30]
    tables = new_tables([(ROW, count) for count in counts])
    assert [(len(table), table.dtype) for table in tables] == [(count, ROW) for count in counts]
    for number, table in enumerate(tables):
        table["a"] = number
    assert all((table["a"] == number).all() for number, table in enumerate(tables))
    large = tables.pop(4)
    assert large.base is not None
    assert large.base.nbytes == large.nbytes, "a large table has its own memory"
    blocks = {id(table.base): table.base.nbytes for table in tables if table.base is not None}
    assert 1 < len(blocks) < 5
    assert max(blocks.values()) <= 33 << 20
    starts = [table.ctypes.data - table.base.ctypes.data for table in tables if table.base is not None]
    assert all(start % 64 == 0 for start in starts), "relative to their block"
