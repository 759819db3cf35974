use super::*;
use crate::encode::{Sender, Version, encode};
use crate::layout::tests::dialect;
use proptest::prelude::*;

fn text(sequence: u8, text: &[u8], version: Version) -> Vec<u8> {
    let dialect = dialect();
    let mut payload = [0; 54];
    payload[1..=text.len()].copy_from_slice(text);
    let mut out = Vec::new();
    let sender = Sender { system: 1, component: 1, sequence };
    encode(&mut out, version, &dialect.layouts()[1], &payload, sender, None).expect("encodes");
    out
}

/// A log larger than two segments, with garbage and embedded packets that mislead a scan starting inside them.
pub(crate) fn log(seed: u64) -> Vec<u8> {
    let mut data = Vec::new();
    let mut state = seed | 1;
    let mut sequence = 0u8;
    while data.len() < 3 * MIN_SEGMENT {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let choice = state >> 56;
        sequence = sequence.wrapping_add(1);
        if choice < 6 {
            data.extend_from_slice(&state.to_le_bytes());
            continue;
        }
        data.extend_from_slice(&(1_700_000_000_000_000 + u64::from(sequence)).to_be_bytes());
        if choice < 128 {
            data.extend(crate::scan::tests::heartbeat(Version::V2, sequence));
        } else {
            // A complete packet inside the text of another: a scan that begins inside accepts the inner one.
            let inner = crate::scan::tests::heartbeat(Version::V1, sequence);
            data.extend(text(sequence, &[&inner[..], &inner[..]].concat(), Version::V2));
        }
    }
    data
}

fn flat(index: &Index) -> (Vec<Vec<u64>>, Statistics, Option<(u64, u64)>) {
    let slots = index.parts.first().map_or(0, |part| part.offsets.len());
    let positions = |slot: usize| {
        let parts = index.parts.iter();
        let all = parts
            .flat_map(|part| part.offsets[slot].iter().map(|&offset| (part.base as u64) << 32 | u64::from(offset)));
        all.map(|position| ((position >> 32) + (position & 0x7FFF_FFFF)) << 1 | (position >> 31 & 1)).collect()
    };
    ((0..slots).map(positions).collect(), index.statistics, index.time_span())
}

#[test]
fn several_threads_give_the_result_of_one() {
    let dialect = dialect();
    for seed in 0..6 {
        let data = log(seed);
        let one = Index::build(&data, &dialect, true, 1);
        assert!(one.rows(0) > 1000 && one.rows(1) > 1000 && one.statistics().bad_bytes > 0);
        for threads in [2, 3] {
            assert_eq!(flat(&Index::build(&data, &dialect, true, threads)), flat(&one), "seed {seed}");
        }
    }
}

#[test]
fn a_segment_with_a_false_start_is_scanned_again() {
    // The middle of the file is a long sequence of packets inside packets: starting points found there are false.
    let dialect = dialect();
    let inner: Vec<u8> = crate::scan::tests::heartbeat(Version::V1, 1);
    let packet = text(1, &[&inner[..], &inner[..]].concat(), Version::V2);
    let data: Vec<u8> = packet.iter().copied().cycle().take(packet.len() * (3 * MIN_SEGMENT / packet.len())).collect();
    let one = Index::build(&data, &dialect, false, 1);
    assert_eq!(flat(&Index::build(&data, &dialect, false, 2)), flat(&one));
    assert_eq!(one.rows(0), 0, "no inner packet is accepted");
}

#[test]
fn rows_hold_time_source_and_payload() {
    let dialect = dialect();
    let mut data = 5u64.to_be_bytes().to_vec();
    data.extend(text(7, b"hi\0junk", Version::V2));
    data.extend(text(8, b"no time", Version::V2));
    let index = Index::build(&data, &dialect, true, 1);
    let size = row_size(&dialect.layouts()[1]);
    let mut rows = vec![0xAA; 2 * size];
    index.decode(&data, &dialect, vec![(1, &mut rows)], 4);
    assert_eq!(&rows[..12], &[5, 0, 0, 0, 0, 0, 0, 0, 1, 1, 7, 2]);
    assert_eq!(&rows[13..20], b"hi\0\0\0\0\0", "the bytes after the NUL are cleared");
    assert!(rows[20..size].iter().all(|&byte| byte == 0), "zero-filled to the full length");
    assert_eq!(i64::from_le_bytes(rows[size..size + 8].try_into().expect("eight")), NO_TIME);
}

#[test]
fn longer_payloads_are_cut_to_the_known_length() {
    let dialect = dialect();
    let mut packet = vec![0xFD, 12, 0, 0, 0, 1, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
    let checksum = crate::crc::accumulate(crate::crc::update(0xFFFF, &packet[1..]), 50);
    packet.extend_from_slice(&checksum.to_le_bytes());
    let index = Index::build(&packet, &dialect, false, 1);
    let mut row = vec![0; row_size(&dialect.layouts()[0])];
    index.decode(&packet, &dialect, vec![(0, &mut row)], 1);
    assert_eq!(&row[ROW_HEADER..], &[1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 0]);
}

#[test]
fn decoding_truncated_data_gives_rows_of_zeros() {
    let dialect = dialect();
    let mut data = crate::scan::tests::heartbeat(Version::V2, 0);
    let index = Index::build(&data, &dialect, false, 1);
    data.truncate(3);
    let mut row = vec![0xAA; row_size(&dialect.layouts()[0])];
    index.decode(&data, &dialect, vec![(0, &mut row)], 1);
    assert!(row.iter().all(|&byte| byte == 0));
}

#[test]
fn decoding_several_tables_equals_decoding_each() {
    let dialect = dialect();
    let data = log(3);
    let index = Index::build(&data, &dialect, true, 2);
    let table = |slot: usize| vec![0xAA; index.rows(slot) * row_size(&dialect.layouts()[slot])];
    let (mut first, mut second) = (table(0), table(1));
    index.decode(&data, &dialect, vec![(0, &mut first), (1, &mut second)], 3);
    for (slot, together) in [(0, first), (1, second)] {
        let mut alone = table(slot);
        index.decode(&data, &dialect, vec![(slot, &mut alone)], 1);
        assert!(alone == together);
        let untimed = NO_TIME.to_le_bytes();
        assert!(
            alone.chunks(row_size(&dialect.layouts()[slot])).all(|row| row[..8] != untimed),
            "each row has a timestamp"
        );
    }
}

proptest! {
    #[test]
    fn random_bytes_never_panic(data in prop::collection::vec(any::<u8>(), 0..2000), timestamped: bool) {
        let dialect = dialect();
        let index = Index::build(&data, &dialect, timestamped, 2);
        let totals = index.statistics();
        prop_assert!(totals.packet_bytes + totals.bad_bytes <= data.len() as u64);
        for (slot, layout) in dialect.layouts().iter().enumerate() {
            let mut rows = vec![0; index.rows(slot) * row_size(layout)];
            index.decode(&data, &dialect, vec![(slot, &mut rows)], 2);
        }
    }
}

#[test]
fn a_saved_index_is_restored() {
    let dialect = dialect();
    let data = log(1);
    let index = Index::build(&data, &dialect, true, 3);
    let saved = index.save(&dialect);
    let restored = Index::restore(&saved, &dialect, data.len()).expect("the index that was saved");
    assert_eq!(flat(&restored), flat(&index));
    assert_eq!(restored.unknown(), index.unknown());
    assert_eq!(restored.sources().all(), index.sources().all());
    let summary = index.without_positions(&dialect);
    assert!(index.has_positions() && !summary.has_positions());
    let restored = Index::restore(&summary.save(&dialect), &dialect, data.len()).expect("the summary that was saved");
    let whole = &index;
    for index in [&summary, &restored] {
        assert_eq!([index.rows(0), index.rows(1)], [whole.rows(0), whole.rows(1)]);
        assert_eq!((index.statistics(), index.time_span()), (whole.statistics(), whole.time_span()));
    }
    let other = Dialect::new(dialect.layouts()[1..].to_vec()).expect("a dialect");
    assert!(Index::restore(&saved, &other, data.len()).is_none());
}

#[test]
fn damaged_bytes_of_an_index_give_none_or_one_that_can_be_used() {
    let dialect = dialect();
    let data = &log(2)[..4000];
    let saved = Index::build(data, &dialect, true, 1).save(&dialect);
    for position in 0..saved.len() {
        assert!(Index::restore(&saved[..position], &dialect, data.len()).is_none());
        for value in [0, 1, 0x7F, 0xFF] {
            let mut changed = saved.clone();
            changed[position] = value;
            if let Some(index) = Index::restore(&changed, &dialect, data.len()) {
                let mut rows = vec![0; index.rows(0) * row_size(&dialect.layouts()[0])];
                index.decode(data, &dialect, vec![(0, rows.as_mut_slice())], 1);
            }
        }
    }
}
