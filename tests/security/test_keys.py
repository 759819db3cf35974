"""Signing keys are never shown."""

from __future__ import annotations

import copy
import errno
import hashlib
import logging
import os
import pickle
import stat
import sys
import traceback

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import FieldRangeError, FieldTypeError, MavstackError, SigningError
from mavstack.security import SigningKey

SECRET = bytes(range(0xA0, 0xC0))


def forms(secret):
    """Return the forms in which a key could appear in a text."""
    return (
        repr(secret)[2:-1],
        secret.hex(),
        secret.hex(" "),
        str(list(secret))[1:-1],
        secret.decode("latin-1"),
    )


def assert_hidden(text, secret=SECRET):
    for form in forms(secret):
        assert form[:16] not in text
        assert form[-16:] not in text


def test_a_key_is_created_from_bytes_hex_or_a_passphrase():
    key = SigningKey(SECRET)
    assert key == SigningKey.from_hex(SECRET.hex()) == SigningKey(bytearray(SECRET))
    assert key.secret_bytes() == SECRET
    assert (
        SigningKey.from_passphrase("pässword").secret_bytes() == hashlib.sha256("pässword".encode()).digest()
    )
    assert SigningKey.generate() != SigningKey.generate()
    assert key != SECRET
    with pytest.raises(TypeError):
        hash(key)


def test_no_text_of_a_key_contains_it(caplog):
    key = SigningKey(SECRET)
    signing = key.signing(3)
    with caplog.at_level(logging.DEBUG):
        logging.getLogger("test").debug("%s %r %s %r", key, key, signing, signing)
    for text in (
        repr(key),
        str(key),
        f"{key}",
        f"{[key]}",
        repr(signing),
        str(signing),
        caplog.text,
        repr(dir(signing)),
    ):
        assert_hidden(text)


@pytest.mark.parametrize(
    "action",
    [
        lambda: SigningKey(SECRET[:-1]),
        lambda: SigningKey(SECRET * 2),
        lambda: SigningKey.from_hex(SECRET.hex()[:-1]),
        lambda: SigningKey.from_hex(SECRET.hex()[:-2]),
        lambda: SigningKey.from_hex(SECRET.hex()[:-2] + "zz"),
        lambda: SigningKey.from_hex("é" + SECRET.hex()),
        lambda: mavstack.Signing(SECRET[:-1]),
        lambda: pickle.dumps(SigningKey(SECRET)),
        lambda: pickle.dumps([SigningKey(SECRET)], 2),
        lambda: copy.deepcopy({"key": SigningKey(SECRET)}),
    ],
)
def test_no_error_contains_a_key(action):
    with pytest.raises(SigningError) as failure:
        action()
    error = failure.value
    assert isinstance(error, MavstackError)
    assert isinstance(error, ValueError)
    assert_hidden("".join(traceback.format_exception_only(error)))
    # The original error must not contain it either, because a traceback shows it.
    assert error.__cause__ is None
    assert error.__suppress_context__ or error.__context__ is None


def test_signing_cannot_be_pickled():
    with pytest.raises(TypeError) as failure:
        pickle.dumps(SigningKey(SECRET).signing())
    assert_hidden(str(failure.value))


def test_the_message_that_carries_a_key_does_not_show_it(caplog):
    message = common.SetupSigning(target_system=7, secret_key=SECRET, initial_timestamp=5)
    (packet,) = mavstack.Parser(common).feed(mavstack.encode(message, system=255, component=190))
    with caplog.at_level(logging.DEBUG):
        logging.getLogger("test").debug("%s %r %s", message, packet, packet.message)
    for text in (
        repr(message),
        str(message),
        f"{message}",
        repr([message]),
        repr(packet.message),
        caplog.text,
    ):
        assert_hidden(text)
    assert "target_system=7" in repr(message)
    assert packet.message.secret_key == SECRET, "the field itself is readable"


def test_a_key_message_of_a_custom_dialect_does_not_show_it(tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text(
        '<mavlink><messages><message id="256" name="SETUP_SIGNING">'
        '<field type="uint8_t" name="target_system"/>'
        '<field type="uint8_t" name="target_component"/><field type="uint8_t[32]" name="secret_key"/>'
        '<field type="uint64_t" name="initial_timestamp"/></message></messages></mavlink>'
    )
    dialect = mavstack.Dialect.from_xml(path)
    assert_hidden(repr(dialect["SETUP_SIGNING"](secret_key=SECRET)))


@pytest.mark.parametrize(
    "wrong", [SECRET + b"x", SECRET.decode("latin-1"), [*SECRET, 0], [*SECRET[:31], 300]]
)
def test_an_error_about_the_key_field_does_not_show_it(wrong):
    with pytest.raises((FieldRangeError, FieldTypeError)) as failure:
        common.SetupSigning(secret_key=wrong)
    assert_hidden(str(failure.value))


# files


def test_key_files_are_readable_by_their_owner_only(tmp_path):
    path = tmp_path / "link.key"
    old = os.umask(0)
    try:
        SigningKey(SECRET).save(path)
    finally:
        os.umask(old)
    if os.name == "posix":
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert SigningKey.load(path) == SigningKey.load(str(path)) == SigningKey(SECRET)


def test_key_files_are_never_overwritten(tmp_path):
    path = tmp_path / "link.key"
    SigningKey(SECRET).save(path)
    with pytest.raises(SigningError, match=r"link\.key") as failure:
        SigningKey.generate().save(path)
    assert_hidden(str(failure.value))
    assert SigningKey.load(path) == SigningKey(SECRET)


@pytest.mark.skipif(os.name != "posix", reason="symbolic links")
def test_a_key_is_not_written_through_a_symbolic_link(tmp_path):
    target = tmp_path / "elsewhere"
    (tmp_path / "link.key").symlink_to(target)
    with pytest.raises(SigningError):
        SigningKey(SECRET).save(tmp_path / "link.key")
    assert not target.exists()


@pytest.mark.parametrize(
    "content", [b"", SECRET, SECRET.hex()[:-2].encode(), b"key: " + SECRET.hex().encode(), b"\xff" * 64]
)
def test_a_damaged_key_file_raises_without_its_content(tmp_path, content):
    path = tmp_path / "link.key"
    path.write_bytes(content)
    with pytest.raises(SigningError, match=r"link\.key") as failure:
        SigningKey.load(path)
    assert_hidden(str(failure.value))
    assert failure.value.__suppress_context__


def test_a_missing_key_file_raises(tmp_path):
    for path in (tmp_path / "none.key", tmp_path):
        with pytest.raises(SigningError, match=str(path.name)):
            SigningKey.load(path)
    with pytest.raises(SigningError):
        SigningKey(SECRET).save(tmp_path / "no" / "folder.key")


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_a_key_file_that_others_can_read_is_reported(tmp_path, caplog):
    path = tmp_path / "fleet.key"
    SigningKey.generate().save(path)
    SigningKey.load(path)
    assert not caplog.records
    path.chmod(0o640)
    SigningKey.load(path)
    assert "mode 640" in caplog.text
    assert "chmod 600" in caplog.text


def test_a_key_that_is_not_on_the_disk_is_no_file(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "fleet.key"
    with monkeypatch.context() as context:
        context.setattr(os, "fsync", full)
        with pytest.raises(SigningError, match="No space left"):
            SigningKey(SECRET).save(path)
    assert not path.exists()
    SigningKey(SECRET).save(path)
    assert SigningKey.load(path) == SigningKey(SECRET)
