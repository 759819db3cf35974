"""The conformance tests of log formats: the test class of a format inherits them and writes the file."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import mavstack
from mavstack.errors import InvalidArgumentError, LogError, UnknownMessageError
from mavstack.logs import Log, LogDamage, TableSchema, TimeBase


def column_bytes(table):
    """Return the bytes of each column, without the padding between them."""
    return {name: table[name].tobytes() for name in table.dtype.names}


class LogConformance:
    """`write` creates a sound log of the format, with at least two tables and some seconds of time."""

    format = ""  # expected `log.format`
    has_start = True  # True if the log knows UTC or receive times
    has_damage_when_truncated = True  # False if a cut of the last byte leaves a sound file

    def write(self, folder):
        """Write a log into a folder and return its path; the name must not tell the format."""
        raise NotImplementedError

    def open_or_refuse(self, path):
        """Return the log, or None if it is refused in one clear line."""
        try:
            return mavstack.open_log(path, format=self.format)
        except LogError as error:
            text = str(error)
        assert text.startswith(f"cannot open {path}: ")
        assert "\n" not in text
        return None

    @pytest.fixture
    def path(self, tmp_path):
        return self.write(tmp_path)

    @pytest.fixture
    def log(self, path):
        return mavstack.open_log(path)

    def test_the_format_is_recognised_by_content(self, log, path):
        assert isinstance(log, Log)
        assert log.format == self.format
        assert log.path == path
        assert log.size == path.stat().st_size
        assert mavstack.open_log(path, format=self.format).counts == log.counts

    def test_counts_are_the_numbers_of_rows(self, log):
        assert len(log) == len(log.counts) >= 2
        assert list(log) == list(log.counts)
        assert {name: len(table) for name, table in log.items()} == log.counts
        assert all(log.counts.values())

    def test_unknown_names_raise(self, log):
        with pytest.raises(UnknownMessageError, match=r"contains no NO_SUCH_TABLE; it contains"):
            log["NO_SUCH_TABLE"]
        with pytest.raises(UnknownMessageError):
            log.schema("NO_SUCH_TABLE")
        with pytest.raises(UnknownMessageError):
            log.select("NO_SUCH_TABLE")
        assert log.get("NO_SUCH_TABLE") is None

    def test_schemas_match_the_types_without_decoding(self, log):
        schemas = {name: log.schema(name) for name in log}
        for name, table in log.items():
            schema = schemas[name]
            assert isinstance(schema, TableSchema)
            assert schema.name == name
            assert schema.names == table.dtype.names
            assert {field.name: field.dtype for field in schema} == {
                column: table.dtype[column] for column in table.dtype.names
            }
            assert table.schema == schema
            assert schema.to_dict()["fields"]

    def test_header_columns(self, log):
        for name, table in log.items():
            assert table.dtype["_time"] == np.dtype("M8[us]"), name
            header = [column for column in table.dtype.names if column.startswith("_")]
            assert list(table.dtype.names[: len(header)]) == header, "header columns come first"
            assert not any(column.startswith("_padding") for column in table.dtype.names)

    def test_tables_keep_their_schema_in_slices_and_pickles(self, log):
        name = max(log.counts, key=log.counts.get)
        table = log[name]
        assert table[:2].schema == table.schema
        assert table[["_time"]].schema.names == ("_time",)
        again = pickle.loads(pickle.dumps(table))
        assert column_bytes(again) == column_bytes(table)
        assert again.schema.to_dict() == table.schema.to_dict()

    @pytest.mark.parametrize("size", [1, 1000, 64 << 20])
    def test_windows_one_after_the_other_are_the_tables(self, log, size):
        calls = []
        windows = list(log.windows(size, progress=lambda done, whole: calls.append((done, whole))))
        assert all(len(table) for window in windows for table in window.values())
        for name, table in log.items():
            parts = [window[name] for window in windows if name in window]
            assert column_bytes(np.concatenate(parts)) == column_bytes(table), name
            assert all(part.schema == table.schema for part in parts)
        assert calls[-1] == (log.size, log.size)
        assert calls == sorted(calls)

    def test_windows_of_some_names(self, log):
        name = next(iter(log))
        windows = list(log.windows(1000, [name, "NO_SUCH_TABLE"]))
        assert {found for window in windows for found in window} == {name}

    def test_loading_and_clearing(self, path):
        with mavstack.open_log(path) as log:
            name, other = list(log)[:2]
            log.load(name, other, name)
            table = log[name]
            assert log[name] is table
            log.clear_cache(name)
            assert log[name] is not table
            assert column_bytes(log[name]) == column_bytes(table)
            log.clear_cache()
            log.load()
        assert column_bytes(table) == column_bytes(log[name]), (
            "tables outlive their log, and a closed log reads again"
        )

    def test_records_are_the_rows(self, log):
        counts = {}
        for record in log.records():
            counts[record.name] = counts.get(record.name, 0) + 1
            assert len(list(record)) == len(record) > 0
        assert counts == log.counts
        name = next(iter(log))
        records = list(log.records(name, "NO_SUCH_TABLE"))
        assert [record.name for record in records] == [name] * log.counts[name]
        times = [record.time for record in records]
        np.testing.assert_array_equal(np.array(times, "M8[us]"), log[name]["_time"])
        field = next(
            item.name for item in log.schema(name) if item.name[0] != "_" and item.dtype.kind in "iuf"
        )
        if not log.schema(name)[field].dtype.shape:
            np.testing.assert_array_equal([record[field] for record in records], log[name][field])

    def test_selecting_tables(self, log):
        name = next(iter(log))
        view = log.select(name)
        assert list(view) == [name]
        assert column_bytes(view[name]) == column_bytes(log[name])
        assert view.schema(name) == log.schema(name)
        assert view.skipped == log.skipped
        assert {record.name for record in view.records()} == {name}
        assert {found for window in view.windows() for found in window} == {name}

    def test_facts_are_read_once(self, log):
        assert log.info is log.info  # an export asks for them in each window
        assert log.vehicles is log.vehicles

    def test_views_are_counted_without_decoding_where_the_index_knows(self, log, monkeypatch):
        name = next(iter(log))
        assert [log.schema(each).name for each in log]  # those of DataFlash depend on the texts
        with monkeypatch.context() as patch:
            patch.setattr(type(log), "decode_tables", lambda *_: pytest.fail("a table was decoded"))
            assert log.select(name).counts == {name: log.counts[name]}
            assert log.select().select(name).counts == {name: log.counts[name]}
        systems = sorted(log.vehicles)
        for selection in ({"system": systems[0]}, {"system": 201}, {"component": 1}, {"instance": 0}):
            view = log.select(**selection)
            expected = {name: len(table) for name, table in view.decode_tables(list(log)).items()}
            assert all(view.counts[name] == expected[name] for name in view.counts)
            assert all(
                not expected[name] for name in log if name not in view.counts and "instance" not in selection
            )

    def test_selecting_times(self, log):
        middle = log.duration / 2
        first, last = log.select(end=middle), log.select(start=middle)
        name = max(log.counts, key=log.counts.get)
        assert 0 < first.counts[name] < log.counts[name]
        seconds = log.seconds_from_start(name, log[name])
        assert first.counts[name] == (seconds < middle).sum()
        assert last.counts[name] == (seconds >= middle).sum()
        assert sum(1 for record in first.records(name)) == first.counts[name]
        assert sum(len(window.get(name, ())) for window in first.windows(1000)) == first.counts[name]
        assert first.duration == pytest.approx(middle)
        if log.start is not None:
            assert log.select(start=log.start).counts[name] == (seconds >= 0).sum()
        with pytest.raises(InvalidArgumentError, match="start must be seconds"):
            log.select(start="yesterday")

    def test_times(self, log):
        assert isinstance(log.time_base, TimeBase)
        assert log.time_base.kind in ("utc", "received", "boot")
        assert log.time_base.kind in log.time_base.describe()
        name = max(log.counts, key=log.counts.get)
        times = log.times(name)
        assert times.shape == (log.counts[name],)
        assert times.dtype == np.float64
        first, last = log.time_span
        assert first - 1e-5 <= np.nanmin(times) <= np.nanmax(times) <= last + 1e-5
        assert log.duration == pytest.approx(last - first)
        assert (log.start is not None) == (log.end is not None) == self.has_start
        with pytest.raises(InvalidArgumentError, match="base must be one of auto, utc"):
            log.times(name, "lunar")

    def test_facts(self, log):
        assert all(isinstance(text, str) for item in log.info.items() for text in item)
        assert all(isinstance(value, int | float) for value in log.parameters.values())
        assert all(change.value != change.before for change in log.parameter_changes)
        assert all(0 <= text.severity <= 7 and text.text for text in log.texts)

    def test_a_sound_file_has_no_damage(self, log):
        assert isinstance(log.skipped, LogDamage)
        assert (log.skipped.total, log.skipped.describe()) == (0, "nothing skipped")

    def test_a_truncated_file_is_read_as_far_as_possible(self, path):
        whole, data = mavstack.open_log(path), path.read_bytes()
        rows = {name: column_bytes(table) for name, table in whole.items()}
        for cut in (len(data) - 1, len(data) * 3 // 4, len(data) // 2):
            path.with_suffix(".cut").write_bytes(data[:cut])
            log = mavstack.open_log(path.with_suffix(".cut"), format=self.format)
            for name, table in log.items():
                assert all(rows[name][key].startswith(value) for key, value in column_bytes(table).items())
            if cut == len(data) - 1 and self.has_damage_when_truncated:
                assert log.skipped.total > 0
        assert 0 < sum(log.counts.values()) < sum(whole.counts.values())

    def test_a_damaged_file_is_read_with_counts(self, path):
        data = bytearray(path.read_bytes())
        place = len(data) * 2 // 3
        data[place : place + 50] = b"\x55" * 50
        path.write_bytes(data)
        log = mavstack.open_log(path)
        log.load()
        assert log.skipped.total > 0
        assert log.skipped.to_dict()["total"] == log.skipped.total

    def test_an_empty_file_has_no_rows_or_is_refused(self, tmp_path):
        path = tmp_path / "empty"
        path.touch()
        log = self.open_or_refuse(path)
        if log is not None:
            assert dict(log) == {}
            assert list(log.windows()) in ([], [{}])

    @pytest.mark.parametrize("data", [b"a text file\n" * 500, bytes(5000), bytes(range(256)) * 40])
    def test_a_file_of_another_kind_has_no_rows_or_is_refused(self, tmp_path, data):
        path = tmp_path / "other"
        path.write_bytes(data)
        log = self.open_or_refuse(path)
        if log is not None:
            assert dict(log) == {}
            assert log.skipped.total > 0

    def test_a_missing_file_is_an_error(self, tmp_path):
        with pytest.raises(LogError, match="cannot open"):
            mavstack.open_log(tmp_path / "missing", format=self.format)
