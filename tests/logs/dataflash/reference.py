"""Tables made by pymavlink's reader of DataFlash logs, message by message."""

from __future__ import annotations

import contextlib
import io
import math

import numpy as np


def pymavlink_rows(path, reader=None):
    """Return the messages of pymavlink by name, as (fields, time) pairs."""
    from pymavlink import DFReader

    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        log = (reader or DFReader.DFReader_binary)(str(path))
        found = {}
        while (message := log.recv_msg()) is not None:
            found.setdefault(message.get_type(), []).append((message.to_dict(), message._timestamp))
        log.close()
    return found


def value_of(value):
    """Return a value as it can be compared: NaN equals NaN, arrays are lists, no NUL ends a text."""
    if isinstance(value, float) and math.isnan(value):
        return "nan"
    if isinstance(value, bytes):
        return value.rstrip(b"\0")
    return list(value) if hasattr(value, "typecode") else value


def our_value(value):
    """Return a value of a table as it can be compared with one of pymavlink."""
    if isinstance(value, np.ndarray):
        return bytes(value).rstrip(b"\0") if value.dtype == np.uint8 else value.tolist()
    if isinstance(value, bytes):
        try:
            return value.decode("utf-8")
        except UnicodeDecodeError:
            return value.decode("latin-1")
    return value_of(value.item() if isinstance(value, np.generic) else value)


def assert_equal_rows(log, name, theirs):
    """Assert that a table equals the messages of pymavlink, row for row and value for value."""
    table = log[name]
    assert len(table) == len(theirs), name
    for field in (field for field in theirs[0][0] if field != "mavpackettype"):
        ours = [our_value(value) for value in table[field]]
        assert ours == [value_of(row[field]) for row, _ in theirs], f"{name}.{field}"
