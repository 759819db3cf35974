"""Comparison of a log with the result of pyulog, value for value."""

from __future__ import annotations

import re

import numpy as np
from pyulog import ULog as PyUlog

from mavstack.logs.ulog import ULog

LEVELS = "01234567"


def assert_same(path):
    """Assert that our reader and pyulog find the same tables, values and texts."""
    ours, peer = ULog(path), PyUlog(str(path))
    assert_same_tables(ours, peer)
    assert_same_values(ours, peer)
    assert_same_texts(ours, peer)
    return ours, peer


def assert_same_tables(ours, peer):
    found = {f"{name}[{number}]" for name, counts in ours.instances.items() for number in counts}
    assert found == {f"{data.name}[{data.multi_id}]" for data in peer.data_list}
    for data in peer.data_list:
        assert_same_table(ours[f"{data.name}[{data.multi_id}]"], data)


def assert_same_table(table, data):
    # We leave out the fields that only align others; pyulog leaves out those at the end of a record.
    names = [name for name in data.data if not re.search(r"(^|\.)_padding\w*(\[\d+\])?$", name)]
    columns = dict.fromkeys(name if name in table.dtype.names else name.rpartition("[")[0] for name in names)
    assert tuple(columns) == table.dtype.names[2:]
    for name in names:
        assert_same_column(table, name, data.data[name])


def assert_same_column(table, name, expected):
    field, _, index = (name, "", "") if name in table.dtype.names else name.rpartition("[")
    column = np.ascontiguousarray(table[field])
    if column.dtype.kind == "S":
        # A text ends at its first NUL; pyulog returns all bytes.
        column = column.view("i1").reshape(len(column), -1)
        is_text = np.logical_and.accumulate(column != 0, axis=1)
        place = int(index.rstrip("]") or 0)
        expected, column = expected[is_text[:, place]], column[:, place][is_text[:, place]]
    elif index:
        column = column[:, int(index.rstrip("]"))]
    if column.dtype.kind == "b":
        expected = expected != 0
    assert column.dtype.itemsize == expected.dtype.itemsize, name
    assert np.ascontiguousarray(column).tobytes() == np.ascontiguousarray(expected).tobytes(), name


def assert_same_values(ours, peer):
    assert comparable(ours.information) == comparable(peer.msg_info_dict)
    assert ours.multi_information == peer.msg_info_multiple_dict
    changed = {name for _, name, _ in peer.changed_parameters}
    # A parameter that appears during the flight has its first value then.
    assert {name: value for name, value in ours.parameters.items() if name in peer.initial_parameters} == (
        peer.initial_parameters
    )
    assert ours.parameters.keys() - peer.initial_parameters.keys() <= changed
    # All messages; `parameter_changes` leaves out those that change nothing.
    assert ours._entries.parameter_changes == peer.changed_parameters
    for number, group in enumerate(("system", "configuration")):
        assert ours.default_parameters.get(group, {}) == peer.get_default_parameters(number)
    dropouts = [(dropout.boot_us, round(dropout.duration * 1000)) for dropout in ours.dropouts]
    assert dropouts == [(dropout.timestamp, dropout.duration) for dropout in peer.dropouts]


def comparable(values):
    """Return values with arrays as bytes, as pyulog returns them."""
    return {
        name: np.array(value, "<f4").tobytes() if isinstance(value, tuple) else value
        for name, value in values.items()
    }


def assert_same_texts(ours, peer):
    plain = [text for text in ours.logged_texts if text.tag is None]
    expected = [
        (text.timestamp, LEVELS.index(chr(text.log_level)), text.message) for text in peer.logged_messages
    ]
    assert [(text.boot_us, text.severity, text.text) for text in plain] == expected
    tagged = {}
    for text in ours.logged_texts:
        if text.tag is not None:
            tagged.setdefault(text.tag, []).append((text.boot_us, text.text))
    peers = {
        tag: [(text.timestamp, text.message) for text in texts]
        for tag, texts in peer.logged_messages_tagged.items()
    }
    assert tagged == peers
