"""The names of the keys during a rotation, also when the program is killed at any step."""

from __future__ import annotations

import pytest

from mavstack.errors import SigningError
from mavstack.security import SigningKey, key_store, rotation
from mavstack.security.key_store import key_names, load_stored_key, store_key
from mavstack.security.rotation import begin_rotation

STEPS = ("store_key", "replace_key", "delete_key")


@pytest.fixture(autouse=True)
def _keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")


def test_a_rotation_keeps_the_old_key_and_gives_its_name_to_the_new_one():
    store_key("fleet", SigningKey.generate())
    first = begin_rotation("fleet")
    assert key_names() == ["fleet", "fleet.next"]
    first.finish()
    second = begin_rotation("fleet")
    assert (second.old, second.resumed) == (first.new, False)
    second.finish()
    assert key_names() == sorted(["fleet", first.old_name, second.old_name])
    assert load_stored_key(first.old_name) == first.old


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("after", [False, True])
def test_a_kill_at_any_step_loses_no_key(step, after, monkeypatch):
    old = SigningKey.generate()
    store_key("fleet", old)
    begun = begin_rotation("fleet")
    known = getattr(rotation, step)

    def killed(*words, **options):
        if after:
            known(*words, **options)
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(rotation, step, killed)
        with pytest.raises(KeyboardInterrupt):
            begun.finish()
    stored = [load_stored_key(name) for name in key_names()]
    assert begun.old in stored
    assert begun.new in stored
    if (step, after) != ("delete_key", True):
        begin_rotation("fleet").finish()
    assert load_stored_key("fleet") == begun.new
    assert load_stored_key(begun.old_name) == old
    assert key_names() == sorted(["fleet", begun.old_name])


def test_an_interrupted_rotation_continues_with_its_key():
    store_key("fleet", SigningKey.generate())
    begun = begin_rotation("fleet")
    resumed = begin_rotation("fleet")
    assert (resumed.resumed, resumed.new == begun.new) == (True, True)


@pytest.mark.parametrize("name", ["missing", "a/b", "x" * 60])
def test_a_bad_name_begins_nothing(name):
    if len(name) == 60:
        store_key(name, SigningKey.generate())
    with pytest.raises(SigningError):
        begin_rotation(name)
    assert not any(known.endswith(".next") for known in key_names())
