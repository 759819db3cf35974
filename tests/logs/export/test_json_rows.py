from __future__ import annotations

import json

import numpy as np

from mavstack.logs.export.json_rows import json_rows


def parsed(**columns):
    return [json.loads(text) for text in json_rows(columns).to_pylist()]


def test_numbers_are_read_back_exactly():
    doubles = np.array([0.1, -1e-300, 1e300, 123456789.0, 5e-324, np.pi])
    singles = np.array([0.1, 1e-30, 3e38, 16777216.0, -1.5, 1 / 3], np.float32)
    large = np.array([0, 1, 2**63, 2**64 - 1, 2**53 + 1, 7], np.uint64)
    rows = parsed(a=doubles, b=singles, c=large)
    assert [row["a"] for row in rows] == doubles.tolist()
    assert [row["b"] for row in rows] == singles.tolist()
    assert [row["c"] for row in rows] == large.tolist()


def test_a_number_that_is_not_finite_is_null():
    assert parsed(a=np.array([np.nan, np.inf, -np.inf, 2.0])) == [{"a": None}] * 3 + [{"a": 2}]


def test_texts_and_truth_values():
    texts = np.array([b'a "b"\\', b"\n\x01", b"\xff", b""])
    rows = parsed(a=texts, b=np.array(["ä", "b", "b", ""], object), c=np.array([True, False, True, False]))
    assert [row["a"] for row in rows] == ['a "b"\\', "\n\x01", "\ufffd", ""]
    assert [row["b"] for row in rows] == ["ä", "b", "b", ""]
    assert [row["c"] for row in rows] == [True, False, True, False]


def test_columns_of_arrays_are_lists():
    numbers = np.arange(12.0).reshape(2, 2, 3)
    numbers[0, 0, 0] = np.nan
    assert parsed(a=numbers, b=np.array([[1], [2]]))[0] == {"a": [[None, 1, 2], [3, 4, 5]], "b": [1]}


def test_columns_of_a_table_are_not_contiguous():
    table = np.array([(1, 2.5, [1, 2]), (3, 4.5, [3, 4])], [("a", "u1"), ("b", "<f4"), ("c", "<i2", 2)])
    assert parsed(**{name: table[name] for name in "abc"}) == [
        {"a": 1, "b": 2.5, "c": [1, 2]},
        {"a": 3, "b": 4.5, "c": [3, 4]},
    ]


def test_keys_are_escaped_and_no_rows_are_no_objects():
    assert parsed(**{'a"b': np.array([1])}) == [{'a"b': 1}]
    assert parsed(a=np.array([], np.float64), b=np.empty((0, 3), "u1"), c=np.array([], "S4")) == []
