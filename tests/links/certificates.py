"""A temporary certificate authority, created by the openssl program; tests are skipped without it."""

from __future__ import annotations

import shutil
import subprocess

import pytest


@pytest.fixture(scope="session")
def certificates(tmp_path_factory):
    """A folder with ca.pem, cert.pem and key.pem (for 127.0.0.1), and locked.pem, an encrypted key."""
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("needs the openssl program")
    folder = tmp_path_factory.mktemp("certificates")

    def run(line: str) -> None:
        subprocess.run([openssl, *line.split()], cwd=folder, check=True, capture_output=True)

    run("req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.pem -days 2 -subj /CN=test-ca"
        " -addext keyUsage=critical,keyCertSign")  # fmt: skip
    run("req -newkey rsa:2048 -nodes -keyout key.pem -out cert.csr -subj /CN=127.0.0.1")
    (folder / "extensions").write_text("subjectAltName=IP:127.0.0.1\nauthorityKeyIdentifier=keyid\n")
    run("x509 -req -in cert.csr -CA ca.pem -CAkey ca.key -CAcreateserial -out cert.pem -days 2"
        " -extfile extensions")  # fmt: skip
    run("rsa -in key.pem -aes128 -passout pass:secret -out locked.pem")
    return folder
