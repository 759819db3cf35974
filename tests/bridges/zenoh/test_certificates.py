from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.zenoh.certificates import FleetCertificates
from mavstack.errors import InvalidArgumentError

x509 = pytest.importorskip("cryptography.x509")

if TYPE_CHECKING:
    from pathlib import Path


def test_certificates_are_of_the_authority(tmp_path: Path) -> None:
    made = FleetCertificates(tmp_path)
    made.make("router", ["ground.example", "10.1.0.1"])
    made.make("alpha")
    ca, router, alpha = (
        x509.load_pem_x509_certificate((tmp_path / f"{name}.pem").read_bytes())
        for name in ("ca", "router", "alpha")
    )
    for each in (router, alpha):
        each.verify_directly_issued_by(ca)
    assert alpha.subject.rfc4514_string() == "CN=alpha"
    names = router.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert names.get_values_for_type(x509.DNSName) == ["router", "ground.example"]
    assert [str(each) for each in names.get_values_for_type(x509.IPAddress)] == ["10.1.0.1"]
    for name in ("ca", "router", "alpha"):
        assert (tmp_path / f"{name}.key").stat().st_mode & 0o077 == 0
    assert len(made.written) == 6


def test_a_fleet_grows(tmp_path: Path) -> None:
    FleetCertificates(tmp_path).make("alpha")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    grown = FleetCertificates(tmp_path)
    grown.make("alpha")
    grown.make("beta")
    assert {path: path.read_bytes() for path in before} == before
    assert [path.name for path in grown.written] == ["beta.key", "beta.pem"]


def test_an_authority_that_cannot_be_read(tmp_path: Path) -> None:
    FleetCertificates(tmp_path)
    (tmp_path / "ca.key").write_text("nonsense")
    with pytest.raises(InvalidArgumentError, match=r"reading the authority .*ca.pem failed"):
        FleetCertificates(tmp_path)
