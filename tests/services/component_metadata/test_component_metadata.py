"""URIs, compressed contents, JSON and general files of component metadata: valid, damaged and hostile."""

from __future__ import annotations

import gzip
import json
import lzma
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import MetadataError
from mavstack.services.component_metadata import (
    MetadataFile,
    ServedMetadata,
    has_crc,
    parse_general,
    parse_json,
    parse_uri,
    unpack_content,
)
from mavstack.services.ftp import FtpLocation, file_crc32

PARAMETER = common.CompMetadataType.PARAMETER


@pytest.mark.parametrize(
    ("uri", "location"),
    [
        ("mftp://etc/extras/general.json.xz", FtpLocation("etc/extras/general.json.xz")),
        ("mftp:///general.json", FtpLocation("/general.json")),
        ("MFTP://comp=100:/general.json", FtpLocation("/general.json", 100)),
        ("mftp://[;comp=12]@MAV_LOG/x.json", FtpLocation("@MAV_LOG/x.json", 12)),
        ("https://host.org/x.json?y=1", "https://host.org/x.json?y=1"),
    ],
)
def test_uri(uri, location):
    assert parse_uri(uri) == location


@pytest.mark.parametrize(
    "uri",
    ["", "mftp://", "file:///etc/passwd", "https://", "mftp://comp=256:x", "mftp://comp=0:x", "mftp://a\nb"],
)
def test_other_uris_are_refused(uri):
    with pytest.raises(MetadataError):
        parse_uri(uri)


def test_contents_in_each_compression():
    content = b'{"version": 1}' * 1000
    for data in (content, lzma.compress(content), gzip.compress(content)):
        assert unpack_content(data) == content
        assert has_crc(data, file_crc32(content))
        assert has_crc(data, file_crc32(data))
        assert not has_crc(data, 1)


@pytest.mark.parametrize("compress", [lzma.compress, gzip.compress])
def test_contents_are_bounded_and_verified(compress):
    bomb = compress(bytes(200_000))
    with pytest.raises(MetadataError, match="more than 100000 bytes"):
        unpack_content(bomb, max_size=100_000)
    with pytest.raises(MetadataError, match=r"ends too early|damaged"):
        unpack_content(bomb[:-5])
    with pytest.raises(MetadataError, match="damaged"):
        unpack_content(bomb[:20] + b"\xff" * 40 + bomb[20:])


def test_json_is_bounded():
    assert parse_json(b'\xef\xbb\xbf{"a": [1]}') == {"a": [1]}
    for data, problem in (
        (b"[1]", "not an object"),
        (b'{"a"', "not JSON"),
        (b'{"a": \xff}', "not UTF-8"),
        (b'{"a": ' + b"9" * 5000 + b"}", "too long"),
        (b'{"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}", "nested too deeply"),
        (b'{"a": [' + b"{}," * 400_000 + b"{}]}", "more values"),
    ):
        with pytest.raises(MetadataError, match=problem):
            parse_json(data)


def test_general_file():
    content = {
        "version": 1,
        "metadataTypes": [
            {
                "type": 1,
                "uri": "mftp://p.json.xz",
                "fileCrc": 7,
                "uriFallback": "https://h/p",
                "fileCrcFallback": 8,
            },
            {"type": 4, "uri": "mftp://e.json", "fileCrc": -1},
            {"type": 5},
            {"type": "1", "uri": "x"},
            "neither",
        ],
    }
    found = parse_general(json.dumps(content).encode())
    assert set(found) == {1, 4}
    assert found[1] == MetadataFile(1, "mftp://p.json.xz", 7, "https://h/p", 8)
    assert found[1].sources == (("mftp://p.json.xz", 7), ("https://h/p", 8))
    assert found[4].sources == (("mftp://e.json", None),)
    with pytest.raises(MetadataError, match="metadataTypes"):
        parse_general(b'{"version": 1}')


def test_served_files_lead_to_each_other():
    served = ServedMetadata("etc/extras", {PARAMETER: ("parameters.json", b'{"parameters": []}')})
    location = parse_uri(served.uri)
    assert isinstance(location, FtpLocation)
    general = unpack_content(served.files[location.path])
    assert file_crc32(general) == served.crc
    file = parse_general(general)[PARAMETER]
    assert file.uri == "mftp://etc/extras/parameters.json.xz"
    data = served.files["etc/extras/parameters.json.xz"]
    assert (file.crc, unpack_content(data)) == (file_crc32(data), b'{"parameters": []}')


@given(st.binary(max_size=300), st.sampled_from([b"", b"\xfd7zXZ\0", b"\x1f\x8b\x08", b"{"]))
def test_hostile_files_raise_only_our_error(data, head):
    for parse in (unpack_content, parse_json, parse_general):
        with suppress(MetadataError):
            parse(head + data)
    with suppress(MetadataError):
        has_crc(head + data, 5)
    with suppress(MetadataError):
        parse_uri(data.decode("latin-1"))
