"""Cameras over random networks: each image is reported once, or a typed error follows in time."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import CommandDenied, RemoteTimeout
from mavstack.services.camera import CameraDevice, CameraInformation, ListStreams, TakePhoto
from mavstack.services.camera.sequence import CaptureSequence
from tests.services.camera.harness import CameraHarness
from tests.services.network import GROUND, random_impairment, with_cuts
from tests.services.single_service import deliver, random_message

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    random = Random(seed)
    harness = CameraHarness(seed=seed, impairment=random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    harness.press_button()
    photos = [harness.run(TakePhoto(0, number)) for number in (1, 2)]
    taken = []
    for photo in photos:
        if photo.error is None:
            taken.append(photo.result().index)
        else:
            assert isinstance(photo.error, RemoteTimeout | CommandDenied)
    assert len(set(taken)) == len(taken)
    assert set(taken) <= set(harness.device.images)
    streams = harness.run(ListStreams(0))
    if streams.error is not None:
        assert isinstance(streams.error, RemoteTimeout)
    else:
        assert {each.id for each in streams.result()} <= {1, 2}
    harness.let_pass(60)
    assert len(set(harness.reported)) == len(harness.reported)
    assert set(taken) <= set(harness.reported)


def test_cameras_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)


@pytest.mark.parametrize(
    "kind",
    [
        common.CameraInformation,
        common.CameraSettings,
        common.CameraCaptureStatus,
        common.CameraImageCaptured,
        common.CameraTrackingImageStatus,
        common.StorageInformation,
        common.VideoStreamInformation,
        common.VideoStreamStatus,
    ],
)
def test_garbage_does_no_harm(kind) -> None:
    random, harness = Random(1), CameraHarness()
    for _ in range(200):
        deliver(harness.monitor, random_message(kind, random), harness.address, harness.network.now)
    harness.let_pass(1)
    assert len(harness.monitor.storages) <= 32
    for number in range(8):
        assert len(harness.monitor.reports(number).missing) <= 200
        assert len(harness.monitor.reports(number).streams) <= 32


@pytest.mark.parametrize("kind", [common.CommandLong, common.CommandInt])
def test_random_commands_do_no_harm(kind) -> None:
    random, harness = Random(1), CameraHarness()
    numbers = (
        *(200, 520, 521, 526, 529, 530, 531, 532, 2000, 2001),
        *(2002, 2004, 2005, 2010, 2500, 2501, 2502, 2503, 512),
    )
    for _ in range(500):
        message = random_message(kind, random).replace(
            target_system=1, target_component=100, command=random.choice(numbers)
        )
        harness.ground.engine.send(message, harness.network.now)
        harness.let_pass(0.05)
    harness.let_pass(1)
    assert harness.ground.engine.local == GROUND


@settings(max_examples=60)
@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("start"), st.floats(0.05, 3.0), st.integers(0, 5)),
            st.tuples(st.just("stop"), st.none(), st.none()),
            st.tuples(st.just("wait"), st.floats(0.0, 5.0), st.none()),
            st.tuples(st.just("reset"), st.none(), st.none()),
        ),
        max_size=12,
    )
)
def test_any_sequence_of_captures_keeps_its_count(steps) -> None:
    images: list[tuple[int, float]] = []
    sequence = CaptureSequence(
        CameraDevice(CameraInformation()), lambda image, now: images.append((image.index, now))
    )
    now = 0.0
    for action, number, count in steps:
        match action:
            case "start":
                sequence.start(number, count, now)
            case "stop":
                sequence.stop()
            case "reset":
                sequence.reset_log()
                images.clear()
            case "wait":
                end = now + number
                while (due := sequence.next_due) is not None and due <= end:
                    assert due >= now
                    now = due
                    sequence.advance(now)
                now = end
        assert [index for index, _ in images] == list(range(sequence.count))
        assert set(sequence.log) == set(range(sequence.count))
