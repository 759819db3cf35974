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
    assert tables[0].base is not None
    assert tables[4].base is None, "a large table has its own memory"
    blocks = {id(table.base): table.base.nbytes for table in tables if table.base is not None}
    assert 1 < len(blocks) < 5
    assert max(blocks.values()) <= 33 << 20
    assert all(
        table.ctypes.data % 64 == tables[0].ctypes.data % 64 for table in tables if table.base is not None
    )
