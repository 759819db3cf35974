from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import LinkURLError
from mavstack.gnss.ntrip import CasterError, NtripClient, NtripURL

URL = NtripURL.parse("ntrip://me:se%2Fcret@caster.example.org:2199/MOUNT")
TABLE = b"STR;NEAR;Zurich;RTCM 3.2;1005(10),1074(1);2;GPS+GLO;SWI;CHE;47.40;8.55;1;0;x;none;B;N;9600;\r\n"
CUTS = st.lists(st.integers(1, 40), min_size=1, max_size=60)


def fed(client: NtripClient, data: bytes, cuts: list[int]) -> bytes:
    found = b""
    for size in [*cuts, len(data)]:
        found += client.feed(data[:size])
        data = data[size:]
    return found


def test_urls():
    assert (URL.host, URL.port, URL.mountpoint, URL.user, URL.password) == (
        "caster.example.org", 2199, "MOUNT", "me", "se/cret",
    )  # fmt: skip
    assert str(URL) == "ntrip://caster.example.org:2199/MOUNT"
    assert "cret" not in repr(URL)
    over_tls = NtripURL.parse("ntrips://[::1]/VRS?version=1&gga=5")
    assert (over_tls.port, over_tls.tls, over_tls.version, over_tls.gga_interval) == (443, True, 1, 5.0)
    assert str(over_tls) == "ntrips://[::1]:443/VRS"


@pytest.mark.parametrize(
    "url",
    [
        "ntrip://",
        "http://a/b",
        "ntrip://a:b/c",
        "ntrip://a/b?gga=x",
        "ntrip://a/b?version=3",
        "ntrip://a?x=1",
    ],
)
def test_malformed_urls(url):
    with pytest.raises(LinkURLError):
        NtripURL.parse(url)


def test_requests_of_both_versions():
    request = NtripClient(URL).request(b"$GPGGA,1*00\r\n").decode()
    assert request.startswith(
        "GET /MOUNT HTTP/1.1\r\nHost: caster.example.org:2199\r\nNtrip-Version: Ntrip/2.0\r\n"
    )
    assert "Authorization: Basic bWU6c2UvY3JldA==\r\n" in request
    assert "Ntrip-GGA: $GPGGA,1*00\r\n" in request
    old = NtripClient(NtripURL.parse("ntrip://a/M?version=1")).request(b"$GPGGA,1*00\r\n").decode()
    assert old == "GET /M HTTP/1.0\r\nUser-Agent: NTRIP Mavstack/1.0\r\n\r\n"


@given(CUTS, st.binary(max_size=200))
def test_version_1(cuts, corrections):
    client = NtripClient(URL)
    assert fed(client, b"ICY 200 OK\r\n" + corrections, cuts).lstrip(b"\r\n") == corrections.lstrip(b"\r\n")
    assert client.is_streaming


@pytest.mark.parametrize("empty_line", [b"", b"\r\n"])
@given(CUTS, st.binary(max_size=50).filter(lambda data: not data.startswith(b"\r")))
def test_the_empty_line_of_version_1_is_not_a_part_of_the_corrections(empty_line, cuts, corrections):
    client = NtripClient(URL)
    assert fed(client, b"ICY 200 OK\r\n" + empty_line + corrections, cuts) == corrections


@given(CUTS, st.lists(st.binary(min_size=1, max_size=90)))
def test_version_2_in_chunks(cuts, parts):
    body = b"".join(b"%x;ext=1\r\n%s\r\n" % (len(part), part) for part in parts)
    head = b"HTTP/1.1 200 OK\r\nContent-Type: gnss/data\r\nTransfer-Encoding: chunked\r\n\r\n"
    client = NtripClient(URL)
    assert fed(client, head + body, cuts) == b"".join(parts)
    assert client.is_streaming


@pytest.mark.parametrize("size", [64, 65])
@given(CUTS)
def test_the_size_of_a_chunk_is_a_short_line_in_any_cut(size, cuts):
    client = NtripClient(URL)
    head = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
    answer = head + b"3;" + b"x" * (size - 2) + b"\r\nabc\r\n"
    if size == 64:
        assert fed(client, answer, cuts) == b"abc"
        return
    with pytest.raises(CasterError, match="malformed"):
        fed(client, answer, cuts)


@given(CUTS)
def test_source_tables(cuts):
    for head in (
        b"SOURCETABLE 200 OK\r\nContent-Type: text/plain\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Type: gnss/sourcetable\r\n\r\n",
    ):
        client = NtripClient(NtripURL.parse("ntrip://caster"))
        assert fed(client, head + b"CAS;x;1\r\n" + TABLE + b"ENDSOURCETABLE\r\n", cuts) == b""
        (entry,) = client.source_table
        assert (entry.mountpoint, entry.format, entry.latitude, entry.needs_gga) == (
            "NEAR",
            "RTCM 3.2",
            47.4,
            True,
        )


@pytest.mark.parametrize(
    ("answer", "reason", "permanent"),
    [
        (b"HTTP/1.1 401 Unauthorized\r\n\r\n", "it refused user and password", True),
        (b"ERROR - Bad Password\r\n", "it refused user and password", True),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "it answered 'HTTP/1.1 404 Not Found'", True),
        (b"HTTP/1.1 503 Busy\r\n\r\n", "it answered 'HTTP/1.1 503 Busy'", False),
        (b"SOURCETABLE 200 OK\r\n\r\n", "it has no mountpoint MOUNT", True),
        (b"SSH-2.0-x\r\n", "it answered 'SSH-2.0-x'", False),
        (b"x" * 20_000, "the answer is not one of NTRIP", True),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n", "its chunks are malformed", False),
    ],
)
def test_refusals(answer, reason, permanent):
    with pytest.raises(CasterError) as caught:
        NtripClient(URL).feed(answer)
    assert str(caught.value).endswith(f"ntrip://caster.example.org:2199/MOUNT failed: {reason}")
    assert caught.value.permanent is permanent


@given(st.lists(st.binary(max_size=100)))
def test_any_answer_is_corrections_or_a_typed_error(chunks):
    client = NtripClient(URL)
    try:
        for chunk in chunks:
            client.feed(chunk)
        client.end()
    except CasterError:
        pass


def test_a_table_that_ends_with_the_connection():
    client = NtripClient(NtripURL.parse("ntrip://caster"))
    client.feed(b"SOURCETABLE 200 OK\r\n\r\n" + TABLE)
    assert client.source_table is None
    client.end()
    assert [entry.mountpoint for entry in client.source_table] == ["NEAR"]
