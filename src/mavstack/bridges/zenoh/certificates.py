"""Certificates of a fleet: its own authority, and a certificate for each router, gateway and station.

An existing authority is used again, and existing certificates are kept, so that a fleet grows.
"""

from __future__ import annotations

from contextlib import suppress
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from cryptography import x509
    from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey

#: Days for which a certificate is valid.
LIFETIME: Final = 825
AUTHORITY_LIFETIME: Final = 3650
AUTHORITY: Final = "ca"
_CLOCK_TOLERANCE: Final = timedelta(hours=1)


class FleetCertificates:
    """The certificates in a folder: `NAME.pem` and `NAME.key`, those of the authority `ca.pem` and `ca.key`.

    Args:
        folder: The folder, which is made.

    Raises:
        MissingExtraError: The library for certificates is not installed.
        OSError: The folder cannot be made, or a file cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        try:
            import cryptography  # noqa: F401
        except ImportError:
            raise MissingExtraError("making certificates", "secure") from None
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        #: The files that were written.
        self.written: list[Path] = []
        self._authority = self._load_authority() or self._make_authority()

    def make(self, name: str, hosts: Sequence[str] = ()) -> None:
        """Make the certificate of an owner, unless it exists.

        Args:
            name: The common name, and the name of the files.
            hosts: Names and addresses under which clients reach it, for a router.
        """
        if (self.folder / f"{name}.pem").exists():
            return
        from cryptography import x509
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import ExtendedKeyUsageOID

        authority, authority_key = self._authority
        key = ec.generate_private_key(ec.SECP256R1())
        usages = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH])
        builder = (
            _builder(name, authority.subject, key, LIFETIME)
            .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
            .add_extension(usages, critical=False)
            .add_extension(
                x509.SubjectAlternativeName([_host(host) for host in (name, *hosts)]), critical=False
            )
            .add_extension(
                x509.AuthorityKeyIdentifier.from_issuer_public_key(authority_key.public_key()), critical=False
            )
        )
        self._write(name, key, builder, authority_key)

    def _make_authority(self) -> tuple[x509.Certificate, EllipticCurvePrivateKey]:
        from cryptography import x509
        from cryptography.hazmat.primitives.asymmetric import ec

        key = ec.generate_private_key(ec.SECP256R1())
        name = "Mavstack fleet authority"
        usage = x509.KeyUsage(
            digital_signature=True,
            content_commitment=False,
            key_encipherment=False,
            data_encipherment=False,
            key_agreement=False,
            key_cert_sign=True,
            crl_sign=True,
            encipher_only=False,
            decipher_only=False,
        )
        builder = (
            _builder(name, None, key, AUTHORITY_LIFETIME)
            .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
            .add_extension(usage, critical=True)
            .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        )
        return self._write(AUTHORITY, key, builder, key), key

    def _load_authority(self) -> tuple[x509.Certificate, EllipticCurvePrivateKey] | None:
        from cryptography import x509
        from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
        from cryptography.hazmat.primitives.serialization import load_pem_private_key

        path = self.folder / f"{AUTHORITY}.pem"
        if not path.exists():
            return None
        try:
            key = load_pem_private_key((self.folder / f"{AUTHORITY}.key").read_bytes(), None)
            certificate = x509.load_pem_x509_certificate(path.read_bytes())
        except (ValueError, TypeError) as error:
            raise InvalidArgumentError(f"reading the authority {path} failed: {error}") from None
        if not isinstance(key, EllipticCurvePrivateKey):
            raise InvalidArgumentError(f"reading the authority {path} failed: its key is not an EC key")
        return certificate, key

    def _write(
        self,
        name: str,
        key: EllipticCurvePrivateKey,
        builder: x509.CertificateBuilder,
        signer: EllipticCurvePrivateKey,
    ) -> x509.Certificate:
        from cryptography.hazmat.primitives import hashes
        from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

        certificate = builder.sign(signer, hashes.SHA256())
        secret = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
        for suffix, data in (("key", secret), ("pem", certificate.public_bytes(Encoding.PEM))):
            path = self.folder / f"{name}.{suffix}"
            write_file_atomically(path, data, private=suffix == "key")
            self.written.append(path)
        return certificate


def _builder(
    name: str, issuer: x509.Name | None, key: EllipticCurvePrivateKey, days: int
) -> x509.CertificateBuilder:
    from cryptography import x509
    from cryptography.x509.oid import NameOID

    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    now = datetime.now(UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer or subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _CLOCK_TOLERANCE)
        .not_valid_after(now + timedelta(days=days))
    )


def _host(text: str) -> x509.GeneralName:
    from cryptography import x509

    with suppress(ValueError):
        return x509.IPAddress(ip_address(text))
    return x509.DNSName(text)
