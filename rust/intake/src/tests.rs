//! The decisions about packets, without sockets; and the thread over real ones.

use crate::channel::{Boot, SharedParser};
use crate::fields::{Fields, HeadingFields, PositionFields};
use crate::intake::{Intake, Peer};
use crate::messages::{Decision, Interest, MAX_STORED};
use crate::queue::{Item, MAX_TAKEN, Takers, Urgency};
use mavstack_core::encode::{Sender, Version, encode};
use mavstack_core::layout::{Dialect, Field, FieldType, Layout};
use mavstack_core::parser::Parser;
use std::collections::HashMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex};

#[path = "reader_tests.rs"]
mod reader;

const HEARTBEAT: u32 = 0;
const POSITION: u32 = 33;
const ATTITUDE: u32 = 30;
const SOURCE: (u8, u8) = (7, 1);

fn dialect() -> Dialect {
    let field =
        |name: &str, kind, offset| Field { name: name.into(), kind, array_length: 0, offset, enumerated: false };
    let layout = |id, name: &str, crc_extra, length, fields| Layout {
        id,
        name: name.into(),
        crc_extra,
        base_length: length,
        length,
        fields,
    };
    Dialect::new(vec![
        layout(HEARTBEAT, "HEARTBEAT", 50, 9, vec![field("type", FieldType::U8, 4)]),
        layout(ATTITUDE, "ATTITUDE", 39, 28, vec![field("time_boot_ms", FieldType::U32, 0)]),
        layout(POSITION, "GLOBAL_POSITION_INT", 104, 28, vec![field("time_boot_ms", FieldType::U32, 0)]),
    ])
    .expect("a valid dialect")
}

fn intake() -> Intake {
    let position = PositionFields { message_id: POSITION, latitude: 4, longitude: 8, speeds: [20, 22] };
    let heading = HeadingFields { message_id: ATTITUDE, roll: 4, pitch: 8, yaw: 12, yaw_speed: 24 };
    let boot = HashMap::from([(POSITION, 0), (ATTITUDE, 0)]);
    Intake::new(Arc::new(dialect()), Fields { boot, position, heading })
}

fn packet(id: u32, payload: &[u8], (system, component): (u8, u8)) -> Vec<u8> {
    let (dialect, mut out) = (dialect(), Vec::new());
    let sender = Sender { system, component, sequence: 0 };
    encode(&mut out, Version::V2, dialect.layout(id).expect("known"), payload, sender, None).expect("fits");
    out
}

fn heartbeat() -> Vec<u8> {
    packet(HEARTBEAT, &[0, 0, 0, 0, 2, 3, 81, 3, 3], SOURCE)
}

fn position(boot_ms: u32, latitude: f64) -> Vec<u8> {
    let mut payload = [0; 28];
    payload[..4].copy_from_slice(&boot_ms.to_le_bytes());
    payload[4..8].copy_from_slice(&((latitude * 1e7) as i32).to_le_bytes());
    packet(POSITION, &payload, SOURCE)
}

fn attitude(boot_ms: u32, yaw: f32) -> Vec<u8> {
    let mut payload = [0; 28];
    payload[..4].copy_from_slice(&boot_ms.to_le_bytes());
    payload[12..16].copy_from_slice(&yaw.to_le_bytes());
    packet(ATTITUDE, &payload, SOURCE)
}

fn decision(interest: Interest) -> Decision {
    Decision { interest, is_listened: false }
}

fn parser() -> SharedParser {
    Arc::new(Mutex::new(Parser::new(false)))
}

fn address(port: u16) -> SocketAddr {
    ([127, 0, 0, 1], port).into()
}

/// An intake that parses channel 1, from port 9 of socket 0.
fn attached() -> Intake {
    let mut intake = intake();
    intake.attach(1, 0, Peer::Address(address(9)), parser());
    intake
}

/// Returns the number of packets that wait and were kept, of those that were not, and of datagrams.
fn taken(intake: &mut Intake) -> (usize, usize, usize) {
    let mut counts = (0, 0, 0);
    for item in intake.queue.take().items {
        match item {
            Item::Packets(run) if run.is_kept => counts.0 += run.packets().count(),
            Item::Packets(run) => counts.1 += run.packets().count(),
            Item::Datagrams(datagrams) => counts.2 += datagrams.count,
        }
    }
    counts
}

#[test]
fn datagrams_of_unknown_senders_and_packets_of_sources_without_a_grant_come_to_the_program() {
    let mut intake = attached();
    intake.receive(0, address(8), &heartbeat(), 1.0);
    intake.receive(0, address(9), &heartbeat(), 1.0);
    intake.messages.decide(SOURCE, HEARTBEAT, decision(Interest::Nothing));
    intake.receive(0, address(9), &heartbeat(), 1.0);
    assert_eq!(taken(&mut intake), (0, 2, 1));
}

#[test]
fn packets_of_a_granted_source_that_are_not_wanted_are_only_kept() {
    let mut intake = attached();
    intake.messages.follow(SOURCE.0);
    assert!(intake.grant(1, SOURCE));
    assert!(!intake.grant(2, SOURCE), "no such channel");
    intake.receive(0, address(9), &heartbeat(), 1.0);
    assert_eq!(intake.messages.take_undecided(), [(SOURCE, HEARTBEAT)]);
    assert_eq!(intake.queue.urgency, Urgency::Now);
    intake.receive(0, address(9), &heartbeat(), 2.0);
    assert!(intake.messages.take_undecided().is_empty(), "the program was asked");
    assert_eq!(taken(&mut intake), (2, 0, 0));
    intake.messages.decide(SOURCE, HEARTBEAT, decision(Interest::Nothing));
    intake.receive(0, address(9), &heartbeat(), 3.0);
    assert_eq!(taken(&mut intake), (0, 0, 0));
    let at = intake.messages.latest(SOURCE.0, SOURCE.1, HEARTBEAT).map(|latest| latest.at);
    assert_eq!(at, Some(3.0));
    intake.messages.forget_interest(Some(HEARTBEAT), 0);
    intake.receive(0, address(9), &heartbeat(), 4.0);
    assert_eq!(taken(&mut intake), (1, 0, 0), "the program decides again");
    let heard: Vec<_> = intake.revoke(SOURCE).into_iter().map(|(channel, state)| (channel, state.heard_at)).collect();
    assert_eq!(heard, [(1, 4.0)]);
    intake.receive(0, address(9), &heartbeat(), 5.0);
    assert_eq!(taken(&mut intake), (0, 1, 0));
}

/// Returns the boot times of the packets that wait, or the counts of datagrams, in order.
fn waiting(intake: &mut Intake) -> Vec<u32> {
    let mut found = Vec::new();
    for item in intake.queue.take().items {
        match item {
            Item::Packets(run) => found.extend(run.packets().map(|(packet, _)| boot_ms_of(packet.payload()))),
            Item::Datagrams(datagrams) => found.push(datagrams.count as u32),
        }
    }
    found
}

fn boot_ms_of(payload: &[u8]) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|index| payload.get(index).copied().unwrap_or(0)))
}

#[test]
fn datagrams_that_wait_are_parsed_in_their_place_when_their_channel_is_attached() {
    let mut intake = intake();
    for step in 0..200_u32 {
        intake.receive(0, address(9), &position(1000 + step, 47.0), 1.0 + f64::from(step));
        if step % 100 == 99 {
            intake.receive(0, address(8), &heartbeat(), 1.0);
        }
    }
    intake.attach(1, 0, Peer::Address(address(9)), parser());
    intake.receive(0, address(9), &position(1200, 47.0), 300.0);
    let activity = intake.take_activity(1);
    assert_eq!((activity.datagrams, activity.valid_at), (201, 300.0));
    let expected: Vec<u32> = (1000..1100).chain([1]).chain(1100..1200).chain([1, 1200]).collect();
    assert_eq!(waiting(&mut intake), expected);
    assert!(!intake.queue.is_waiting());
}

#[test]
fn packets_that_wait_are_kept_when_their_source_is_granted_and_dropped_when_no_part_takes_them() {
    let mut intake = attached();
    intake.messages.follow(SOURCE.0);
    let other = packet(HEARTBEAT, &[0, 0, 0, 0, 2, 3, 81, 3, 3], (8, 1));
    for step in 0..300_u32 {
        intake.receive(0, address(9), &position(1000 + step, 47.0), 1.0);
        if step % 100 == 99 {
            intake.receive(0, address(9), &other, 1.0);
        }
    }
    assert!(intake.grant(1, SOURCE));
    intake.receive(0, address(9), &position(1300, 47.0), 2.0);
    let latest = |intake: &Intake| intake.messages.latest(SOURCE.0, SOURCE.1, POSITION).map(|latest| latest.at);
    assert_eq!(latest(&intake), Some(2.0));
    assert_eq!(intake.messages.take_undecided(), [(SOURCE, POSITION)]);
    assert!(intake.grant(1, SOURCE), "it is granted");
    assert!(!intake.messages.take_decided());
    intake.drop_unwanted();
    intake.messages.decide(SOURCE, POSITION, decision(Interest::Nothing));
    assert!(intake.messages.take_decided() && !intake.messages.take_decided());
    let before = intake.queue.is_waiting();
    intake.drop_unwanted();
    assert_eq!((before, taken(&mut intake)), (true, (0, 3, 0)), "those of the other source");
    assert!(!intake.queue.is_full() && !intake.queue.is_waiting());
}

#[test]
fn packets_of_a_granted_source_that_wait_keep_their_order_and_those_that_are_taken_stay() {
    let mut intake = attached();
    for step in 0..400_u32 {
        let one = if step % 2 == 0 { position(step, 47.0) } else { attitude(step, 0.0) };
        intake.receive(0, address(9), &one, 1.0);
    }
    intake.grant(1, SOURCE);
    intake.receive(0, address(9), &position(400, 47.0), 1.0);
    intake.messages.decide(SOURCE, ATTITUDE, decision(Interest::Nothing));
    intake.messages.decide(SOURCE, POSITION, Decision { interest: Interest::Nothing, is_listened: true });
    intake.drop_unwanted();
    assert_eq!(waiting(&mut intake), (0..=400).step_by(2).collect::<Vec<_>>());
}

#[test]
fn the_host_of_a_channel_may_send_from_any_port() {
    let mut intake = intake();
    intake.attach(2, 0, Peer::Address(address(8)), parser());
    intake.attach(1, 0, Peer::Host(address(9).ip()), parser());
    intake.receive(0, address(7), &heartbeat(), 1.0);
    assert_eq!(taken(&mut intake), (0, 1, 0), "any port of the host");
    let length = heartbeat().len() as u64;
    let activity = intake.detach(1);
    assert_eq!((activity.bytes, activity.datagrams), (length, 1));
    intake.receive(0, address(7), &heartbeat(), 1.0);
    assert_eq!(taken(&mut intake), (0, 0, 1));
}

#[test]
fn a_new_channel_of_an_address_gets_its_datagrams_from_the_channel_of_the_host() {
    let mut intake = intake();
    intake.attach(1, 0, Peer::Host(address(9).ip()), parser());
    intake.receive(0, address(9), &heartbeat(), 1.0);
    intake.queue.take();
    intake.attach(2, 0, Peer::Address(address(9)), parser());
    intake.receive(0, address(9), &heartbeat(), 1.0);
    assert_eq!((intake.detach(1).datagrams, intake.detach(2).datagrams), (1, 1));
}

/// Returns how many of these packets come to the program; each has a time.
fn passed(packets: impl IntoIterator<Item = (f64, Vec<u8>)>) -> usize {
    let mut intake = attached();
    intake.grant(1, SOURCE);
    for id in [POSITION, ATTITUDE] {
        intake.messages.decide(SOURCE, id, decision(Interest::NewBoot));
    }
    intake.expect_boot(1, SOURCE, Some(Boot::new(10_000, 1.0)));
    for (now, data) in packets {
        intake.receive(0, address(9), &data, now);
    }
    taken(&mut intake).0
}

#[test]
fn states_that_continue_those_before_do_not_come() {
    let time = |step: u32| (1.0 + f64::from(step) * 0.01, 10_000 + step * 10);
    assert_eq!(passed((0..300).map(time).map(|(now, boot_ms)| (now, position(boot_ms, 47.0)))), 1, "the first one");
    assert_eq!(passed((0..300).map(time).map(|(now, boot_ms)| (now, attitude(boot_ms, now as f32 / 3.0)))), 1);
}

#[test]
fn the_program_learns_which_boot_time_was_expected_last() {
    let mut intake = attached();
    intake.grant(1, SOURCE);
    intake.messages.decide(SOURCE, ATTITUDE, decision(Interest::NewBoot));
    intake.expect_boot(1, SOURCE, Some(Boot::new(10_000, 1.0)));
    let last = |intake: &Intake| intake.boot(1, SOURCE).map(|boot| (boot.boot_ms, boot.seen_at));
    intake.receive(0, address(9), &attitude(10_300, 0.0), 1.25);
    assert_eq!(last(&intake), Some((10_300, 1.25)));
    intake.receive(0, address(9), &attitude(500, 0.0), 1.5);
    assert_eq!(last(&intake), Some((10_300, 1.25)), "another boot");
    assert!(intake.boot(2, SOURCE).is_none() && intake.boot(1, (9, 1)).is_none());
    let revoked = intake.revoke(SOURCE);
    assert_eq!(revoked[0].1.boot.map(|boot| boot.boot_ms), Some(10_300));
}

#[test]
fn the_expected_boot_time_follows_a_clock_that_is_fast() {
    let steps = (0..3000_u32).map(|step| (1.0 + f64::from(step) * 0.01, 10_000 + step * 11));
    assert_eq!(passed(steps.map(|(now, boot_ms)| (now, attitude(boot_ms, 0.0)))), 1, "three seconds ahead in the end");
}

#[test]
fn each_state_of_two_vehicles_in_turns_comes_to_the_program() {
    let turns = |step: u32| (1.0 + f64::from(step) * 0.001, 10_000 + step, step.is_multiple_of(2));
    let place = |is_first| if is_first { 47.0 } else { 47.1 };
    assert_eq!(passed((0..40).map(turns).map(|(now, boot_ms, first)| (now, position(boot_ms, place(first))))), 40);
    let yaw = |is_first| if is_first { 3.1 } else { 1.0 };
    assert_eq!(passed((0..40).map(turns).map(|(now, boot_ms, first)| (now, attitude(boot_ms, yaw(first))))), 40);
}

#[test]
fn a_heading_turns_over_north_and_means_nothing_without_a_number() {
    let turning = [(1.01, 3.1), (1.02, -3.1), (1.03, 3.1), (1.04, f32::NAN), (1.05, 3.1)];
    let packets = turning.into_iter().enumerate();
    let count = passed(packets.map(|(step, (now, yaw))| (now, attitude(10_010 + 10 * step as u32, yaw))));
    assert_eq!(count, 1, "the first one");
}

#[test]
fn each_boot_time_that_is_not_expected_comes_to_the_program() {
    let other_boot = (0..40).map(|step| (1.01 + f64::from(step) * 0.001, position(500_000 + step, 47.0)));
    assert_eq!(passed(other_boot), 40);
}

#[test]
fn packets_that_only_listeners_take_need_no_check_of_the_engine() {
    let mut intake = attached();
    intake.grant(1, SOURCE);
    intake.messages.decide(SOURCE, HEARTBEAT, Decision { interest: Interest::Nothing, is_listened: true });
    intake.receive(0, address(9), &heartbeat(), 1.0);
    assert_eq!(intake.queue.take_fresh(), Urgency::Prompt);
    let items = intake.queue.take().items;
    let Some(Item::Packets(run)) = items.first() else { panic!("no packets") };
    assert!(run.packets().all(|(_, takers)| takers == Takers { engine: false, listeners: true }));
}

#[test]
fn the_program_takes_a_part_of_many_packets_at_once_and_all_in_order() {
    let mut intake = attached();
    for number in 0..2000_u32 {
        intake.receive(0, address(9), &position(number, 47.0), 1.0);
    }
    let mut boot_times = Vec::new();
    while intake.queue.is_waiting() {
        let items = intake.queue.take().items;
        let before = boot_times.len();
        for item in &items {
            let Item::Packets(run) = item else { panic!("no packets") };
            boot_times.extend(run.packets().map(|(packet, _)| boot_ms_of(packet.payload())));
        }
        assert!(boot_times.len() - before <= MAX_TAKEN);
        assert_eq!(intake.queue.urgency > Urgency::None, intake.queue.is_waiting());
    }
    assert!((0..2000).eq(boot_times));
}

#[test]
fn bytes_that_the_program_reads_are_parsed_across_their_bounds() {
    let mut intake = intake();
    intake.attach_fed(4, parser());
    let packet = heartbeat();
    assert!(!intake.feed(4, &packet[..9], 1.0));
    assert!(intake.feed(4, &packet[9..], 1.0));
    assert!(!intake.feed(5, &packet, 1.0), "no such channel");
    assert_eq!(taken(&mut intake), (0, 1, 0));
}

#[test]
fn the_program_is_woken_once_for_what_waits_and_gets_a_socket_after_it() {
    let mut intake = attached();
    assert!(!intake.queue.announce(), "nothing waits");
    for number in 0..1000_u32 {
        intake.receive(0, address(9), &position(number, 47.0), 1.0);
    }
    assert!(intake.queue.announce());
    assert!(!intake.queue.announce(), "it is announced");
    intake.queue.overload(0);
    assert!(intake.queue.take().overloaded.is_empty());
    assert_eq!(intake.queue.take().overloaded, [0]);
    intake.receive(0, address(9), &heartbeat(), 1.0);
    assert!(intake.queue.announce());
}

#[test]
fn the_latest_packets_of_a_system_are_bounded() {
    let mut intake = attached();
    intake.messages.follow(SOURCE.0);
    let raw: Vec<Vec<u8>> = (1..=250).map(|component| packet(HEARTBEAT, &[0; 9], (SOURCE.0, component))).collect();
    let dialect = dialect();
    for number in 0..3000_u32 {
        let mut parser = Parser::new(false);
        parser.feed(&dialect, &raw[number as usize % 250], |mut one| {
            one.header.message_id = 1000 + number / 250;
            intake.messages.keep(&one, f64::from(number));
        });
    }
    assert!((MAX_STORED / 2..=MAX_STORED).contains(&intake.messages.stored(SOURCE.0)));
    assert_eq!(intake.messages.newest_time(SOURCE.0), Some(2999.0));
    intake.messages.unfollow(SOURCE.0);
    assert_eq!(intake.messages.stored(SOURCE.0), 0);
}
