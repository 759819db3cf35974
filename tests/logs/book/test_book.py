"""The flight book of a folder of logs."""

from __future__ import annotations

import csv
import datetime
from pathlib import Path

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.book import COLUMNS, FlightBook
from tests.logs.files import encoded, stamped
from tests.logs.flights import flight_tlog, packets

ONE = str(Path("logs", "2023", "one.tlog"))


@pytest.fixture
def folder(tmp_path):
    logs = tmp_path / "logs"
    (logs / "2023").mkdir(parents=True)
    (logs / "2023" / "one.tlog").write_bytes(flight_tlog())
    (logs / "notes.txt").write_text("no log")
    return logs


def test_a_flight_has_a_row(folder, tmp_path):
    with FlightBook(tmp_path / "book.duckdb") as book:
        update = book.update(folder)
        assert (update.read, update.unchanged, update.failed) == (1, 0, {})
        first, second = book.rows()
    assert list(first) == list(COLUMNS)
    assert first["file"] == ONE
    assert (first["vehicle"], second["vehicle"]) == (1, 2)
    assert (first["vehicle_type"], first["date"]) == ("QUADROTOR", datetime.date(2023, 11, 14))
    assert first["flight_time_s"] == pytest.approx(6.0)
    assert (first["first_takeoff_s"], first["last_landing_s"]) == (2.0, 8.0)
    assert first["first_latitude"] == pytest.approx(47.0)
    assert first["last_latitude"] == pytest.approx(47.0009)
    assert first["distance_m"] == pytest.approx(100.1, abs=0.1)
    assert first["max_altitude_m"] == 7.0
    assert second["flight_time_s"] == 0.0


def test_only_changed_logs_are_read_again_and_remarks_stay(folder, tmp_path):
    path = tmp_path / "book.duckdb"
    with FlightBook(path) as book:
        book.update(folder)
        assert book.add_incident(ONE, "propeller lost") == 2
    (folder / "two.tlog").write_bytes(stamped(packets(), start=1_800_000_000_000_000))
    with FlightBook(path) as book:
        update = book.update(folder)
        assert (update.read, update.unchanged) == (1, 1)
        (folder / "2023" / "one.tlog").write_bytes(flight_tlog() + b"x")
        calls = []
        update = book.update(folder, lambda *done: calls.append(done))
        assert (update.read, update.unchanged) == (1, 1)
        assert calls == [(1, 2), (2, 2)]
        assert [row["incidents"] for row in book.rows()] == ["propeller lost"] * 2 + [""] * 2
        (folder / "two.tlog").unlink()
        assert book.update(folder).removed == 1
        assert len(book.rows()) == 2


def test_a_log_that_cannot_be_read_does_not_stop_the_others(folder, tmp_path):
    (folder / "bad.bin").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
    with FlightBook(tmp_path / "book.duckdb") as book:
        update = book.update(folder)
        assert list(update.failed) == [str(Path("logs", "bad.bin"))]
        assert len(book.rows()) == 2


def test_damage_is_in_the_book(folder, tmp_path):
    (folder.parent / ONE).write_bytes(flight_tlog() + b"junk")
    with FlightBook(tmp_path / "book.duckdb") as book:
        assert book.update(folder).skipped == {ONE: "4 bad bytes"}
        assert {row["skipped"] for row in book.rows()} == {"4 bad bytes"}
        assert book.update(folder).skipped == {}


def test_a_book_of_an_earlier_version_gets_new_columns(folder, tmp_path):
    import duckdb

    with FlightBook(tmp_path / "book.duckdb") as book:
        book.update(folder)
        book.add_incident(ONE, "propeller lost")
    with duckdb.connect(str(tmp_path / "book.duckdb")) as connection:
        connection.execute("ALTER TABLE flights DROP COLUMN skipped")
    with FlightBook(tmp_path / "book.duckdb") as book:
        assert book.update(folder).read == 1
        assert [(row["incidents"], row["skipped"]) for row in book.rows()] == [("propeller lost", "")] * 2
    with FlightBook(tmp_path / "book.duckdb") as book:
        assert book.update(folder).unchanged == 1


def test_the_book_as_csv(folder, tmp_path):
    with FlightBook(tmp_path / "book.duckdb") as book:
        book.update(folder)
        book.export_csv(tmp_path / "book.csv")
        with pytest.raises(LogError, match="cannot write"):
            book.export_csv(tmp_path / "none" / "book.csv")
        assert len(book.rows()) == 2
    with FlightBook(tmp_path / "book.duckdb") as book:
        book.export_csv(tmp_path / "book.csv")
    with (tmp_path / "book.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["vehicle"] for row in rows] == ["1", "2"]


def test_wrong_paths_are_reported(folder, tmp_path):
    other = tmp_path / "other.duckdb"
    other.write_bytes(b"no database" * 1000)
    with pytest.raises(LogError, match=f"cannot open the flight book {other}"):
        FlightBook(other)
    with FlightBook(tmp_path / "book.duckdb") as book, pytest.raises(LogError, match="it is not a folder"):
        book.update(tmp_path / "nowhere")


def test_an_interrupted_update_keeps_the_remarks(folder, tmp_path, monkeypatch):
    path = tmp_path / "book.duckdb"
    with FlightBook(path) as book:
        book.update(folder)
        book.add_incident(ONE, "propeller lost")
        (folder.parent / ONE).write_bytes(flight_tlog() + b"x")
        forget = book._forget

        def interrupt(name):
            forget(name)
            raise KeyboardInterrupt

        monkeypatch.setattr(book, "_forget", interrupt)
        with pytest.raises(KeyboardInterrupt):
            book.update(folder)
    with FlightBook(path) as book:
        assert [row["incidents"] for row in book.rows()] == ["propeller lost"] * 2
        assert book.update(folder).read == 1


def test_a_log_that_is_removed_meanwhile_is_reported(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "rglob", lambda self, pattern: [Vanishing(folder.parent / ONE)])
    with FlightBook(tmp_path / "book.duckdb") as book:
        assert list(book.update(folder).failed) == [ONE]


class Vanishing(type(Path())):
    """A file that is there when the folder is listed, and gone when it is looked at."""

    def is_file(self):
        return True

    def stat(self, **_):
        raise FileNotFoundError(2, "No such file or directory")


def test_the_first_takeoff_and_the_last_landing(folder, tmp_path):
    armed = [False, True, False, False, True, True, False, False]
    beats = [common.Heartbeat(type=2, autopilot=3, base_mode=129 if now else 1) for now in armed]
    (folder.parent / ONE).write_bytes(stamped(encoded(beats), step=1_000_000))
    with FlightBook(tmp_path / "book.duckdb") as book:
        book.update(folder)
        (row,) = [row for row in book.rows() if row["file"] == ONE]
    assert (row["first_takeoff_s"], row["last_landing_s"], row["flight_time_s"]) == (1.0, 6.0, 3.0)


def test_logs_of_other_folders_stay(folder, tmp_path):
    other = tmp_path / "other" / "2023"
    other.mkdir(parents=True)
    (other / "one.tlog").write_bytes(flight_tlog())
    book_folder = tmp_path / "books"
    book_folder.mkdir()
    with FlightBook(book_folder / "book.duckdb") as book:
        assert book.update(folder).read == 1
        first = str(tmp_path / ONE)
        assert book.add_incident("2023/one.tlog", "propeller lost") == 2
        assert (book.update(other.parent).read, book.update(other).unchanged) == (1, 1)
        assert {row["file"] for row in book.rows()} == {first, str(other / "one.tlog")}
        with pytest.raises(InvalidArgumentError, match=r"one\.tlog names several logs of the book: "):
            book.add_incident("one.tlog", "x")
        assert book.add_incident("ne.tlog", "x") == 0
        (other / "one.tlog").unlink()
        assert (book.update(folder).removed, book.update(other).removed) == (0, 1)
        assert [row["incidents"] for row in book.rows()] == ["propeller lost"] * 2


def test_a_book_beside_its_logs_can_be_moved(folder, tmp_path):
    with FlightBook(folder / "flights.duckdb") as book:
        book.update(folder)
    moved = folder.rename(tmp_path / "moved")
    with FlightBook(moved / "flights.duckdb") as book:
        assert book.update(moved).unchanged == 1


@pytest.mark.parametrize("suffix", [".bbl", ".BFL", ".ulg", ".pcapng"])
def test_logs_of_every_format_are_looked_at(tmp_path, suffix):
    (tmp_path / f"flight{suffix}").write_bytes(b"no log of any format")
    with FlightBook(tmp_path / "book.duckdb") as book:
        assert list(book.update(tmp_path).failed) == [f"flight{suffix}"]


def test_a_book_that_moved_without_its_logs_keeps_their_rows(folder, tmp_path):
    with FlightBook(folder / "flights.duckdb") as book:
        book.update(folder)
        book.add_incident("one.tlog", "propeller lost")
    other = tmp_path / "other"
    other.mkdir()
    (other / "two.tlog").write_bytes(flight_tlog())
    (folder / "flights.duckdb").rename(other / "flights.duckdb")
    with FlightBook(other / "flights.duckdb") as book:
        update = book.update(other)
        assert (update.read, update.removed) == (1, 0)
        remarks = {row["file"]: row["incidents"] for row in book.rows()}
        assert remarks == {"two.tlog": "", str(folder / "2023" / "one.tlog"): "propeller lost"}
        assert book.update(folder).unchanged == 1, "the rows are those of the logs that stayed"
