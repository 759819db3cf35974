use super::*;
use crate::encode::{Sender, Version, encode};
use crate::layout::tests::dialect;
use crate::signing::{Key, Policy, Signing};

pub(crate) fn heartbeat(version: Version, sequence: u8) -> Vec<u8> {
    heartbeat_of_mode(version, sequence, 0)
}

fn heartbeat_of_mode(version: Version, sequence: u8, mode: u8) -> Vec<u8> {
    let dialect = dialect();
    let mut out = Vec::new();
    let sender = Sender { system: 1, component: 1, sequence };
    encode(&mut out, version, &dialect.layouts()[0], &[mode, 0, 0, 0, 2, 3, 81, 4, 3], sender, None).expect("encodes");
    out
}

/// A valid packet whose message id is not in the dialect.
fn unknown_packet(payload: &[u8]) -> Vec<u8> {
    let mut packet = vec![MAGIC_V2, payload.len() as u8, 0, 0, 9, 1, 1, 0x39, 0x30, 0];
    packet.extend_from_slice(payload);
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &packet[1..]), 123);
    packet.extend_from_slice(&checksum.to_le_bytes());
    packet
}

fn scan(data: &[u8], timestamped: bool) -> (Vec<FrameSpan>, Statistics) {
    let dialect = dialect();
    let mut statistics = Statistics::default();
    let mut scanner = Scanner::new(data, &dialect, timestamped);
    let mut found = Vec::new();
    while let Some(packet) = scanner.next_packet_at_end(&mut statistics) {
        found.push(packet);
    }
    (found, statistics)
}

#[test]
fn a_false_magic_hides_no_packet() {
    for version in [Version::V1, Version::V2] {
        let mut data = vec![MAGIC_V2, 0xC8];
        for sequence in 0..10 {
            data.extend(heartbeat(version, sequence));
        }
        let (dialect, mut statistics) = (dialect(), Statistics::default());
        let mut scanner = Scanner::new(&data, &dialect, false);
        let found = std::iter::from_fn(|| scanner.next_packet(&mut statistics)).count();
        assert_eq!(found, 10, "without waiting for the end of the stream");
    }
}

#[test]
fn only_the_damaged_packet_is_lost() {
    let mut data = heartbeat(Version::V2, 0);
    data[12] ^= 0xFF;
    data.extend(heartbeat(Version::V1, 1));
    let (found, statistics) = scan(&data, false);
    assert_eq!(found.len(), 1);
    assert_eq!((statistics.bad_checksum, statistics.bad_bytes), (1, 21));
}

#[test]
fn a_checksum_byte_equal_to_a_magic_starts_no_packet() {
    let mut data = Vec::new();
    let mut packets = 0;
    for number in 0..=0x0FFFu16 {
        let [sequence, extra] = number.to_le_bytes();
        let packet = heartbeat_of_mode(Version::V2, sequence, extra);
        if matches!(packet.last(), Some(&(MAGIC_V1 | MAGIC_V2))) {
            data.extend(&packet);
            packets += 1;
        }
    }
    assert!(packets > 0, "the sample contains such a checksum");
    let (found, statistics) = scan(&data, false);
    assert_eq!((found.len(), statistics.bad_bytes), (packets, 0));
}

#[test]
fn unknown_ids_are_counted_as_unknown_and_not_as_damaged() {
    let data = unknown_packet(&[1, 2, 3]);
    let (found, statistics) = scan(&data, false);
    assert_eq!((found.len(), found[0].slot, found[0].header.message_id), (1, None, 12345));
    assert_eq!((statistics.unknown, statistics.bad_checksum), (1, 0));
}

#[test]
fn damaged_packets_of_unknown_ids_are_mostly_refused() {
    let accepted = (0..=0x03FFu16).filter(|&damage| {
        let mut data = unknown_packet(&[1, 2, 3, 4, 5, 6, 7, 8]);
        data[10 + usize::from(damage >> 8)] ^= damage as u8 | 1;
        !scan(&data, false).0.is_empty()
    });
    assert!(accepted.count() < 32, "about one in 256 has a solution");
}

#[test]
fn an_apparent_unknown_packet_hides_no_valid_packet() {
    let data = unknown_packet(&heartbeat(Version::V2, 3));
    let (found, _) = scan(&data, false);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].header.message_id, 0);
}

#[test]
fn unknown_incompatibility_flags_are_refused_and_compatibility_flags_ignored() {
    let mut refused = heartbeat(Version::V2, 0);
    refused[2] = 0x02;
    let (found, statistics) = scan(&refused, false);
    assert_eq!((found.len(), statistics.bad_flags), (0, 1));
    let mut ignored = heartbeat(Version::V2, 0);
    ignored[3] = 0xFF;
    let end = ignored.len() - 2;
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &ignored[1..end]), 50);
    ignored[end..].copy_from_slice(&checksum.to_le_bytes());
    assert_eq!(scan(&ignored, false).0.len(), 1);
}

#[test]
fn version_1_packets_shorter_than_their_message_are_refused() {
    let mut short = vec![MAGIC_V1, 5, 0, 1, 1, 0, 0, 0, 0, 0, 2];
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &short[1..]), 50);
    short.extend_from_slice(&checksum.to_le_bytes());
    let (found, statistics) = scan(&short, false);
    assert_eq!((found.len(), statistics.bad_length), (0, 1));
}

#[test]
fn timestamps_are_not_bad_bytes_and_junk_between_packets_is() {
    let mut data = vec![7; 5];
    for sequence in 0..3 {
        data.extend_from_slice(&(1_700_000_000_000_000u64 + u64::from(sequence)).to_be_bytes());
        data.extend(heartbeat(Version::V2, sequence));
    }
    data.extend_from_slice(b"junk");
    data.extend_from_slice(&1_700_000_000_000_003u64.to_be_bytes());
    data.extend(heartbeat(Version::V1, 3));
    let (found, statistics) = scan(&data, true);
    assert_eq!(found.len(), 4);
    assert!(found.iter().all(|packet| packet.timestamped));
    assert_eq!(statistics.bad_bytes, 9);
    assert!(looks_timestamped(&data, &dialect()));
}

#[test]
fn a_stream_without_timestamps_does_not_look_timestamped() {
    let data: Vec<u8> = (0..4).flat_map(|sequence| heartbeat(Version::V2, sequence)).collect();
    assert!(!looks_timestamped(&data, &dialect()));
}

#[test]
fn a_log_that_starts_inside_a_packet_is_parsed_from_the_next_one() {
    let mut data = heartbeat(Version::V2, 0)[9..].to_vec();
    data.extend_from_slice(&1_700_000_000_000_000u64.to_be_bytes());
    data.extend(heartbeat(Version::V2, 1));
    let (found, statistics) = scan(&data, true);
    assert_eq!((found.len(), found[0].timestamped, statistics.bad_bytes), (1, true, 12));
}

pub(crate) fn signed_heartbeat(sequence: u8) -> Vec<u8> {
    let dialect = dialect();
    let mut out = Vec::new();
    let sender = Sender { system: 1, component: 1, sequence };
    let mut signing = Signing::new(Key::new([7; 32]), 3, 1000 + u64::from(sequence), Policy::default());
    let payload = [0, 0, 0, 0, 2, 3, 81, 4, 3];
    encode(&mut out, Version::V2, &dialect.layouts()[0], &payload, sender, Some((&mut signing, None)))
        .expect("encodes");
    out
}

#[test]
fn a_signature_that_lacks_bytes_hides_no_packet() {
    let next: [fn(u8) -> Vec<u8>; 3] =
        [|number| heartbeat(Version::V1, number), |number| heartbeat(Version::V2, number), signed_heartbeat];
    for (missing, next) in (1..=SIGNATURE).flat_map(|missing| next.map(|next| (missing, next))) {
        let mut data = signed_heartbeat(1);
        data.truncate(data.len() - missing);
        data.extend(next(2));
        data.extend(next(3));
        let (found, statistics) = scan(&data, false);
        let sequences: Vec<u8> = found.iter().map(|packet| packet.header.sequence).collect();
        assert_eq!(sequences, [1, 2, 3], "{missing} bytes missing");
        assert_eq!(statistics.packet_bytes + statistics.bad_bytes, data.len() as u64);
    }
}

#[test]
fn a_whole_packet_inside_a_signature_is_found() {
    let mut data = signed_heartbeat(1);
    data.truncate(data.len() - SIGNATURE);
    let mut short = vec![MAGIC_V2, 1, 0, 0, 2, 1, 1, 0, 0, 0, 7];
    let checksum = crc::accumulate(crc::update(crc::INITIAL, &short[1..]), 50);
    short.extend_from_slice(&checksum.to_le_bytes());
    assert_eq!(short.len(), SIGNATURE);
    data.extend(short);
    data.extend(signed_heartbeat(3));
    let sequences: Vec<u8> = scan(&data, false).0.iter().map(|packet| packet.header.sequence).collect();
    assert_eq!(sequences, [1, 2, 3]);
}

#[test]
fn junk_after_a_signed_packet_is_counted_once() {
    let mut data = signed_heartbeat(1);
    data.extend([0xFE, 9, 0, 1, 1, 0, 7, 7]);
    data.extend([0; 30]);
    data.extend(signed_heartbeat(2));
    let (found, statistics) = scan(&data, false);
    assert_eq!((found.len(), statistics.bad_bytes), (2, 38));
    assert_eq!((statistics.packet_bytes, statistics.bad_checksum), (68, 1));
}
