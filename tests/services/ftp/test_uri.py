"""URIs of files on components: both notations of a component, percent escapes, and refused URIs."""

from __future__ import annotations

import pytest

from mavstack.services.ftp import FtpLocation, parse_ftp_uri


@pytest.mark.parametrize(
    ("uri", "location"),
    [
        ("mftp://camera.xml", FtpLocation("camera.xml")),
        ("mftp:///info/camera%20one.xml.xz", FtpLocation("/info/camera one.xml.xz")),
        ("mftp://[;comp=1]/camera.xml", FtpLocation("/camera.xml", 1)),
        ("mftp://comp=100:/camera.xml", FtpLocation("/camera.xml", 100)),
        ("MAVLINKFTP://[;comp=100]camera.xml", FtpLocation("camera.xml", 100)),
        ("mftp://[;comp=12]@MAV_LOG/x.json", FtpLocation("@MAV_LOG/x.json", 12)),
        ("mftp://[;comp=999]/camera.xml", None),
        ("mftp://comp=0:camera.xml", None),
        ("mftp://", None),
        ("mftp:///", None),
        ("mftp://a\nb", None),
        (f"mftp://{'a' * 500}", None),
        ("http://camera/camera.xml", None),
        ("", None),
    ],
)
def test_parse_ftp_uri(uri: str, location: FtpLocation | None) -> None:
    assert parse_ftp_uri(uri) == location
