from __future__ import annotations

import io

import numpy as np
import pyarrow as pa
from mcap.reader import NonSeekingReader, make_reader

from mavstack.logs.export import mcap_stream
from mavstack.logs.export.mcap_stream import McapStream


def file_of(messages):
    """Return a file with a channel for each topic, to which the messages are added in turn."""
    file = io.BytesIO()
    stream = McapStream(file)
    schema = stream.add_schema("thing", b"{}")
    channels = {topic: stream.add_channel(topic, schema) for topic in ("/a", "/b")}
    for topic, times, contents in messages:
        stream.add_messages(channels[topic], np.array(times, np.uint64), pa.array(contents, pa.string()))
    stream.add_metadata("note", {"a": "b"})
    stream.finish()
    file.seek(0)
    return file


def read(reader, **options):
    return [
        (channel.topic, message.log_time, message.data.decode())
        for _, channel, message in reader.iter_messages(**options)
    ]


def test_messages_of_several_chunks(monkeypatch):
    monkeypatch.setattr(mcap_stream, "_CHUNK", 2000)
    messages = [
        ("/a", list(range(0, 1000, 2)), [f"a{number}" for number in range(500)]),
        ("/b", list(range(1, 1001, 2)), ["b" * (number % 90) for number in range(500)]),
        ("/a", [1001], ["x" * 9000]),
    ]
    expected = sorted(
        (
            (topic, time, text)
            for topic, times, texts in messages
            for time, text in zip(times, texts, strict=True)
        ),
        key=lambda message: message[1],
    )
    file = file_of(messages)
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    assert len(summary.chunk_indexes) > 5
    assert summary.statistics.message_count == 1001
    assert summary.statistics.channel_message_counts == {1: 501, 2: 500}
    assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (0, 1001)
    assert read(reader) == expected
    assert read(reader, topics=["/b"], starting_at=101, ending_before=104) == [
        message for message in expected if message[0] == "/b" and 101 <= message[1] < 104
    ]
    assert [record.name for record in reader.iter_metadata()] == ["note"]
    file.seek(0)
    assert sorted(read(NonSeekingReader(file))) == sorted(expected)


def test_no_messages():
    reader = make_reader(file_of([("/a", [], [])]), validate_crcs=True)
    assert read(reader) == []
    assert reader.get_summary().statistics.message_count == 0
