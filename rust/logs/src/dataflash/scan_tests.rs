use super::*;
use crate::dataflash::samples::{Log, random_log};
use proptest::prelude::*;

/// Slots of the records, and the walk after the last one.
fn walk(data: &[u8]) -> (Vec<u16>, Walk<'_>) {
    let mut walk = Walk::new(data, Place::START, Formats::default());
    let mut slots = Vec::new();
    walk.run(data.len(), |record| slots.push(record.slot));
    (slots, walk)
}

#[test]
fn an_intact_log_has_no_damage() {
    let mut log = Log::with_types();
    log.a(1, 0, 5).t(2, "hello").a(3, 1, 6);
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 2, 1]);
    assert_eq!(walk.damage, Damage::default());
    assert_eq!(walk.redefinitions.len(), 2);
}

#[test]
fn junk_is_skipped_and_counted() {
    let mut log = Log::with_types();
    log.a(1, 0, 5).junk(&[0; 100]).a(2, 0, 6).a(3, 0, 7);
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 1, 1]);
    assert_eq!(walk.damage, Damage { bad_bytes: 100, suspect_records: 1, ..Damage::default() });
}

#[test]
fn a_record_that_lost_bytes_is_dropped_and_the_next_one_is_found() {
    let mut log = Log::with_types();
    log.t(1, "lost").cut(5).a(2, 0, 6).a(3, 0, 7);
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 1]);
    assert_eq!(walk.damage, Damage { bad_bytes: 22, damaged_records: 1, ..Damage::default() });
}

#[test]
fn false_headers_in_junk_are_not_records() {
    let mut log = Log::with_types();
    log.junk(&[1, 0xA3, 0x95, 1, 0xA3, 0xA3, 0x95]).junk(&[7; 30]).a(2, 0, 6).a(3, 0, 7);
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 1]);
    assert_eq!(walk.damage.bad_bytes, 37);
}

#[test]
fn records_of_unknown_types_are_counted() {
    let mut log = Log::with_types();
    log.a(1, 0, 5).record(9, &[0; 20]).record(9, &[0; 20]).a(2, 0, 6).record(10, &[0; 4]);
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 1]);
    assert_eq!(walk.damage.unknown, BTreeMap::from([(9, 2), (10, 1)]));
    assert_eq!(walk.damage.bad_bytes, 23 + 23 + 7);
}

#[test]
fn a_truncated_tail_is_counted() {
    for (cut, truncated) in [(1, 26), (24, 3), (25, 2), (26, 1), (27, 0)] {
        let mut log = Log::with_types();
        log.a(1, 0, 5).t(2, "last").cut(cut);
        let (slots, walk) = walk(&log.0);
        assert_eq!(slots, [0, 0, 1]);
        let expected = Damage { bad_bytes: truncated, truncated_bytes: truncated, ..Damage::default() };
        assert_eq!(walk.damage, expected, "cut by {cut}");
    }
}

#[test]
fn a_type_number_can_change_its_meaning() {
    let mut log = Log::with_types();
    log.a(1, 0, 5).define(1, "C", "QB", "TimeUS,X", 12).record(1, &[0; 9]).t(2, "t");
    let (slots, walk) = walk(&log.0);
    assert_eq!(slots, [0, 0, 1, 0, 3, 2]);
    assert_eq!(walk.damage, Damage::default());
    assert_eq!(walk.formats.definitions()[3].name, b"C");
}

#[test]
fn a_definition_before_junk_does_not_count() {
    let mut log = Log::with_types();
    log.define(1, "C", "QB", "TimeUS,X", 12).junk(&[0; 20]).a(1, 0, 5).a(2, 0, 5);
    assert_eq!(walk(&log.0).0, [0, 0, 0, 1, 1], "its last bytes may be damaged");
}

#[test]
fn an_empty_log_and_junk_have_no_records() {
    assert_eq!(walk(&[]).1.damage, Damage::default());
    let (slots, walk) = walk(&[0x55; 5000]);
    assert!(slots.is_empty());
    assert_eq!(walk.damage.bad_bytes, 5000);
}

#[test]
fn a_walk_can_stop_and_continue_anywhere() {
    let data = random_log(5, 20_000);
    let (slots, whole) = walk(&data);
    let (mut parts, mut found) = (Walk::new(&data, Place::START, Formats::default()), Vec::new());
    for end in (0..=data.len()).step_by(7) {
        parts.run(end, |record| found.push(record.slot));
        let damage = parts.damage;
        parts = Walk::new(&data, parts.place, parts.formats);
        parts.damage = damage;
    }
    parts.run(data.len(), |record| found.push(record.slot));
    assert_eq!((found, parts.damage), (slots, whole.damage));
}

proptest! {
    #[test]
    fn every_byte_is_in_a_record_or_counted(seed: u64, cut in 0usize..2000, flips in prop::collection::vec(any::<(u16, u8)>(), 0..20)) {
        let mut data = random_log(seed, 4000);
        for (place, value) in flips {
            let place = usize::from(place) % data.len();
            data[place] = value;
        }
        data.truncate(data.len() - cut);
        let mut walk = Walk::new(&data, Place::START, Formats::default());
        let (mut end, mut starts) = (0, Vec::new());
        walk.run(data.len(), |record| starts.push(record));
        let mut bytes = 0;
        for record in starts {
            let length = usize::from(walk.formats.definitions()[usize::from(record.slot)].length);
            prop_assert!(record.start >= end && record.start + length <= data.len());
            end = record.start + length;
            bytes += length as u64;
        }
        prop_assert_eq!(bytes + walk.damage.bad_bytes, data.len() as u64);
    }

    #[test]
    fn random_bytes_never_panic(data in prop::collection::vec(any::<u8>(), 0..2000)) {
        walk(&data);
    }
}
