"""The sender of corrections: fragments, epochs, pace."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.gnss.rtcm import RtcmFrame
from mavstack.services.rtk import ChannelPace, CorrectionReceived, CorrectionReceiver, CorrectionSender
from tests.gnss.test_rtcm import msm, station
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, feed_random_messages, run_timers, sent_by


def sender_of(*paces: ChannelPace) -> CorrectionSender:
    channels = paces or (ChannelPace("fast", None),)
    return CorrectionSender(GROUND, lambda: channels)


def test_frames_arrive_whole():
    sender, receiver = sender_of(), CorrectionReceiver(VEHICLE)
    frames = [station(), msm(1074, 1, 600), msm(1084, 1, 354)]
    sender.feed(b"junk" + b"".join(frame.data for frame in frames), START)
    for message in sent_by(sender):
        deliver(receiver, message, GROUND, START)
    found = [event.frame for event in receiver.events() if isinstance(event, CorrectionReceived)]
    assert found == frames
    assert (sender.counts.frames, sender.counts.sent, sender.counts.bad_bytes) == (3, 3, 4)
    assert sender.counts.numbers == {1005: 1, 1074: 1, 1084: 1}


def test_each_channel_gets_each_fragment_once():
    sender = sender_of(ChannelPace("a", None), ChannelPace("b", None))
    sender.feed(msm(1074, 1, 400).data, START)
    names = [outgoing.channel for outgoing in sender.messages_to_send(START)]
    assert sorted(names) == ["a"] * 3 + ["b"] * 3


def test_long_frames_are_counted_and_left_out():
    sender = sender_of()
    sender.feed(msm(1077, 1, 900).data, START)
    assert sent_by(sender) == []
    assert sender.counts.too_long == 1


def test_frames_about_the_station_are_thinned_out():
    sender = sender_of()
    for second in range(21):
        sender.feed(station().data, START + second)
    assert len(sent_by(sender)) == 1  # the waiting one is replaced, the others are left out
    assert sender.counts.thinned == 18
    other = RtcmFrame.of(station().data[3:-3] + b"x")
    sender.feed(other.data, START + 21)
    assert len(sent_by(sender)) == 1


def test_a_slow_channel_has_one_fragment_at_a_time():
    sender = sender_of(ChannelPace("radio", 5760.0))
    sender.feed(msm(1074, 1, 400).data, START)
    assert len(sent_by(sender)) == 1
    later = run_timers(sender, START + 1)
    assert [message.len for _, message in later] == [180, 46]
    gaps = [time - START for time, _ in later]
    assert 0.06 < gaps[0] < 0.07
    assert 0.13 < gaps[1] < 0.14


def test_an_epoch_replaces_the_waiting_one_but_no_begun_frame():
    sender = sender_of(ChannelPace("radio", 1000.0))
    sender.feed(msm(1074, 1, 400).data + msm(1084, 1, 100).data, START)
    assert len(sent_by(sender)) == 1  # the first fragment of 1074
    sender.feed(msm(1074, 2, 100).data + msm(1084, 2, 100).data + msm(1084, 2, 101).data, START + 0.1)
    assert sender.counts.late == 1  # 1084 of the first epoch; the two of the second belong together
    sizes = [message.len for _, message in run_timers(sender, START + 3)]
    assert sizes == [180, 46, 106, 106, 107]


def test_what_is_late_is_dropped():
    sender = sender_of(ChannelPace("radio", None))
    sender.feed(msm(1074, 1).data, START)
    assert sent_by(sender, START, lambda target, priority, channel: False) == []
    assert sender.next_timeout() is None  # waits for room, not for a time
    assert sent_by(sender, START + 3) == []
    assert sender.counts.late == 1


def test_a_closed_channel_is_forgotten():
    paces = [ChannelPace("radio", 10.0)]
    sender = CorrectionSender(GROUND, lambda: paces)
    sender.feed(msm(1074, 1, 400).data, START)
    sent_by(sender)
    paces.clear()
    sender.handle_timeout(sender.next_timeout())
    assert sender.next_timeout() is None


def test_random_messages():
    for seed in range(20):
        feed_random_messages(CorrectionReceiver(VEHICLE), [common.GpsRtcmData], seed)
