use super::header::{HEADER, Header, HeaderError, MAGIC};
use super::index::{Index, Options};
use super::layout::{FieldType, Format, Layout};
use super::scan::SYNC;
use crate::rows::NO_TIME;
use proptest::prelude::*;
use std::collections::HashMap;

fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    let mut out = (body.len() as u16).to_le_bytes().to_vec();
    out.push(kind);
    out.extend(body);
    out
}

fn start() -> Vec<u8> {
    [MAGIC, &[1], &5u64.to_le_bytes()].concat()
}

fn flags(incompatible: u8, offsets: [u64; 3]) -> Vec<u8> {
    let mut body = vec![0; 8];
    body.push(incompatible);
    body.extend([0; 7]);
    body.extend(offsets.iter().flat_map(|offset| offset.to_le_bytes()));
    message(b'B', &body)
}

fn subscription(id: u16, instance: u8, name: &str) -> Vec<u8> {
    message(b'A', &[&[instance], &id.to_le_bytes()[..], name.as_bytes()].concat())
}

fn record(id: u16, record: &[u8]) -> Vec<u8> {
    message(b'D', &[&id.to_le_bytes()[..], record].concat())
}

/// A record of `pair:uint64_t timestamp;uint8_t _padding0;uint16_t value;uint8_t[3] _padding1;` without its end.
fn pair(id: u16, time: u64, value: u16) -> Vec<u8> {
    record(id, &[&time.to_le_bytes()[..], &[0xEE], &value.to_le_bytes()].concat())
}

fn definitions() -> Vec<u8> {
    let mut data = start();
    data.extend(message(b'F', b"pair:uint64_t timestamp;uint8_t _padding0;uint16_t value;uint8_t[3] _padding1;"));
    data.extend(message(b'I', b"\x10char[3] sys_namePX4"));
    data.extend(subscription(3, 0, "pair"));
    data.extend(subscription(4, 2, "pair"));
    data
}

/// A log with records of two instances, marks and texts.
fn log(count: u64) -> Vec<u8> {
    let mut data = definitions();
    for number in 0..count {
        data.extend(pair(3 + (number % 3 == 0) as u16, number, number as u16));
        if number % 16 == 0 {
            data.extend(message(b'S', SYNC));
            data.extend(message(b'L', &[b"6\x01\0\0\0\0\0\0\0text", &number.to_le_bytes()[..]].concat()));
        }
    }
    data
}

fn build(data: &[u8]) -> Index {
    build_with(data, Options::default())
}

fn build_with(data: &[u8], options: Options) -> Index {
    Index::build(data, &Header::parse(data).expect("a header"), options)
}

/// The rows of a table as (time, instance, record without padding).
fn rows(index: &Index, data: &[u8], table: &str) -> Vec<(i64, u8, Vec<u8>)> {
    let table = index.table(table).expect("a table");
    let size = index.tables()[table].layout.row_size;
    let mut buffer = vec![0xAA; index.rows(table) * size];
    index.decode(data, vec![(table, buffer.as_mut_slice())], Some(1000), 2);
    let time = |row: &[u8]| i64::from_le_bytes(row[..8].try_into().expect("8 bytes"));
    buffer.chunks(size).map(|row| (time(row), row[8], row[12..].to_vec())).collect()
}

fn values(index: &Index, data: &[u8]) -> Vec<u16> {
    rows(index, data, "pair").iter().map(|row| u16::from_le_bytes([row.2[8], row.2[9]])).collect()
}

fn layout(definitions: &[&str]) -> Option<Layout> {
    let formats = definitions.iter().map(|text| Format::parse(text.as_bytes()).expect("a format"));
    let formats: HashMap<_, _> = formats.map(|format| (format.name.clone(), format)).collect();
    Layout::build("a", &formats, &mut 100_000)
}

#[test]
fn records_become_rows_without_padding() {
    let data = [definitions(), pair(3, 7, 11), pair(4, 8, 12), message(b'R', &[3, 0])].concat();
    let index = build(&data);
    let body = |time: u64, value: u16| [&time.to_le_bytes()[..], &value.to_le_bytes(), &[0, 0]].concat();
    assert_eq!(rows(&index, &data, "pair"), [(1007, 0, body(7, 11)), (1008, 2, body(8, 12))]);
    assert_eq!(index.instances(0), [1, 0, 1]);
    assert_eq!(index.time_span, Some((7, 8)));
    assert_eq!(
        index.entries.iter().map(|entry| entry.kind).filter(|kind| !b"FA".contains(kind)).collect::<Vec<_>>(),
        [b'I']
    );
    assert_eq!(index.damage, super::scan::Damage::default());
}

#[test]
fn header_and_flags_are_checked() {
    assert_eq!(Header::parse(b"ULog\x01"), Err(HeaderError::Short(5)));
    assert_eq!(Header::parse(b"\xa3\x95\x80"), Err(HeaderError::Magic));
    let refused = [start(), flags(2, [0; 3])].concat();
    assert!(matches!(Header::parse(&refused), Err(HeaderError::IncompatibleFlags([2, ..]))));
    let header = Header::parse(&[start(), flags(1, [70, 60, 9000]), vec![0; 100]].concat()).expect("appended data");
    assert_eq!((header.appended, header.bad_offsets), (vec![70], 2));
}

#[test]
fn appended_data_follows_a_cut_message() {
    let mut data = [start(), flags(1, [0; 3]), definitions()[HEADER..].to_vec(), pair(3, 1, 1)].concat();
    data.extend(&pair(3, 2, 2)[..9]);
    let offset = data.len() as u64;
    data.extend(pair(3, 3, 3));
    data.splice(HEADER..HEADER + 43, flags(1, [offset, 0, 0]));
    let index = build(&data);
    assert_eq!(values(&index, &data), [1, 3]);
    assert_eq!(index.damage.truncated_bytes, 9);
}

#[test]
fn nested_definitions_and_arrays() {
    let layout = layout(&[
        "a:uint64_t timestamp;b[2] esc;char[4] name;bool on;uint8_t _padding0;",
        "b:float rpm;uint8_t[2] _padding0;int8_t[3] q;",
    ]);
    let layout = layout.expect("a layout");
    let columns: Vec<_> =
        layout.fields.iter().map(|field| (field.name.as_str(), field.kind, field.count, field.offset)).collect();
    assert_eq!(
        columns,
        [
            ("timestamp", FieldType::U64, 0, 12),
            ("esc[0].rpm", FieldType::F32, 0, 20),
            ("esc[0].q", FieldType::I8, 3, 24),
            ("esc[1].rpm", FieldType::F32, 0, 27),
            ("esc[1].q", FieldType::I8, 3, 31),
            ("name", FieldType::Char, 4, 34),
            ("on", FieldType::Bool, 0, 38),
        ]
    );
    assert_eq!((layout.min_record, layout.max_record, layout.row_size, layout.timestamp), (31, 32, 40, Some(0)));
}

#[test]
fn unusable_definitions_are_refused() {
    for text in ["", "a", "a:", ":int8_t x;", "a:int8_t;", "a:int8_t[ x;", "a:int8_t[0] x;", "float:int8_t x;"] {
        assert_eq!(Format::parse(text.as_bytes()), None, "{text}");
    }
    for text in ["a:a x;", "a:missing x;", "a:double[9000] x;", "a:int8_t x;int8_t x;", "a:uint8_t _padding0;"] {
        assert_eq!(layout(&[text]), None, "{text}");
    }
    let mut budget = 50_000;
    let formats =
        ["a:b[60000] x;", "b:int8_t _padding0;"].map(|text| Format::parse(text.as_bytes()).expect("a format"));
    let formats = formats.map(|format| (format.name.clone(), format)).into();
    assert_eq!((Layout::build("a", &formats, &mut budget), budget), (None, 0));
}

#[test]
fn texts_end_at_nul_and_truth_values_are_0_or_1() {
    let mut data = start();
    data.extend(message(b'F', b"a:char[4] text;bool[2] on;char letter;"));
    data.extend(subscription(0, 0, "a"));
    data.extend(record(0, b"x\0yz\x02\0q"));
    let index = build(&data);
    assert_eq!(rows(&index, &data, "a"), [(NO_TIME, 0, b"x\0\0\0\x01\0q\0".to_vec())]);
}

#[test]
fn unusable_records_are_counted() {
    let data = [
        definitions(),
        record(9, b"unknown id"),
        record(3, b"size"),
        message(b'Z', b"a later kind"),
        pair(3, 1, 1),
        subscription(5, 0, "missing"),
        pair(5, 1, 1),
        pair(4, 2, 2),
    ];
    let data = data.concat();
    let index = build(&data);
    assert_eq!(values(&index, &data), [1, 2]);
    assert_eq!((index.damage.wrong_size, index.damage.bad_definitions, index.damage.bad_bytes), (1, 1, 0));
    assert_eq!(index.damage.unsubscribed, [(5, 1), (9, 1)].into());
    assert_eq!(index.damage.unknown_kinds, [(b'Z', 1)].into());
}

#[test]
fn a_damaged_size_costs_one_record() {
    let good = log(40);
    let records: Vec<usize> = (0..40).map(|number| position(&good, number)).collect();
    for &at in &records {
        for size in [0, 1, 12, 17, 30, 500, 0xFFFF_u16] {
            let mut data = good.clone();
            data[at..at + 2].copy_from_slice(&size.to_le_bytes());
            let index = build(&data);
            assert_eq!(values(&index, &data).len(), 39, "size {size} at {at}");
        }
    }
}

#[test]
fn lost_bytes_cost_one_record() {
    let good = log(40);
    for number in 0..39 {
        let at = position(&good, number);
        for lost in 1..9 {
            let mut data = good.clone();
            data.drain(at + 7..at + 7 + lost);
            let index = build(&data);
            assert_eq!(values(&index, &data).len(), 39, "{lost} bytes of record {number}");
        }
    }
}

#[test]
fn a_message_of_an_unknown_kind_does_not_swallow_others() {
    let good = log(40);
    let (at, end) = (position(&good, 3), position(&good, 30));
    let junk = [&((end - at) as u16).to_le_bytes()[..], b"9"].concat();
    let data = [&good[..at], &junk, &good[at..]].concat();
    let index = build(&data);
    assert_eq!(values(&index, &data).len(), 40);
    assert_eq!(index.damage.bad_bytes, 3);
}

/// Position of the record with a value.
fn position(data: &[u8], value: u64) -> usize {
    let time = value.to_le_bytes();
    (0..data.len()).find(|&at| data[at + 2] == b'D' && data[at + 5..].starts_with(&time)).expect("a record")
}

#[test]
fn a_lost_subscription_leaves_the_other_topics() {
    let mut data = [definitions(), record(7, b"0123456789").repeat(50), pair(3, 1, 1)].concat();
    assert_eq!(build(&data).damage.unsubscribed, [(7, 50)].into());
    data.extend(vec![0; 5000]);
    data.extend(pair(4, 2, 2));
    let index = build(&data);
    assert_eq!(values(&index, &data), [1, 2]);
    assert_eq!((index.damage.bad_bytes, index.damage.gaps), (5000, 1));
}

#[test]
fn subscriptions_may_change() {
    let other = message(b'F', b"other:uint64_t timestamp;uint16_t value;uint8_t x;");
    let changed = message(b'F', b"pair:uint64_t timestamp;");
    let data = [definitions(), pair(3, 1, 1), other, subscription(3, 0, "other"), changed, pair(3, 2, 2)].concat();
    let index = build(&data);
    assert_eq!((index.rows(0), index.rows(1), index.damage.bad_definitions), (1, 1, 1));
}

#[test]
fn parts_of_a_file_give_the_rows_of_the_whole() {
    let data = log(3000);
    let whole = values(&build(&data), &data);
    let header = Header::parse(&data).expect("a header");
    for size in [1, 100, 5000, 1 << 20] {
        let mut index = Some(Index::first(&data, &header, size, Options::default()));
        let mut pieces = Vec::new();
        let mut last = 0;
        while let Some(part) = index {
            assert!(part.entries.iter().all(|entry| entry.time >= last));
            last = part.entries.last().map_or(last, |entry| entry.time);
            if part.table("pair").is_some() {
                pieces.extend(values(&part, &data));
            }
            index = part.following(&data, size, Options::default());
        }
        assert!(pieces == whole, "size {size}");
    }
}

fn summary(index: &Index, data: &[u8]) -> String {
    let names: Vec<_> = index.tables().iter().map(|table| table.name.as_str()).collect();
    let rows: Vec<_> = names.iter().map(|name| rows(index, data, name)).collect();
    let counts = (index.time_span, index.definitions_end, index.message_bytes);
    format!("{names:?} {rows:?} {:?} {:?} {counts:?}", index.entries, index.damage)
}

/// Checks that no byte is lost, and that several threads give the result of one.
fn check(data: &[u8]) {
    let Ok(header) = Header::parse(data) else { return };
    let one = Index::build(data, &header, Options::default());
    let damage = &one.damage;
    assert_eq!(one.message_bytes + damage.bad_bytes + damage.truncated_bytes, (data.len() - HEADER) as u64);
    let result = summary(&one, data);
    let restored = Index::restore(&one.save(), data, &header).expect("the index that was saved");
    assert_eq!((summary(&restored, data), restored.end()), (result.clone(), one.end()));
    let without = Index::restore(&one.without_positions().save(), data, &header).expect("the index that was saved");
    assert_eq!(summary(&without, &[]), summary(&one.without_positions(), &[]));
    assert!((0..one.tables().len()).all(|table| without.instances(table) == one.instances(table)));
    for (threads, min_segment) in [(2, 1), (3, 64), (5, 300)] {
        let several = Index::build(data, &header, Options { threads, min_segment, positions: true });
        assert_eq!(summary(&several, data), result);
        let options = Options { threads, min_segment, positions: true };
        let mut covered = 0;
        let steps = Index::first_in_steps(data, &header, data.len(), options, 2 * min_segment, |part| {
            assert_eq!(part.start, covered);
            covered = part.end;
        });
        assert_eq!(covered, steps.end());
        assert_eq!(summary(&steps, data), result);
        assert_eq!(format!("{:?}", steps.without_positions().entries), format!("{:?}", one.entries));
    }
    for (number, table) in one.tables().iter().enumerate() {
        let mut buffer = vec![0; one.rows(number) * table.layout.row_size];
        one.decode(&data[..data.len() / 2], vec![(number, buffer.as_mut_slice())], Some(1), 1);
    }
}

/// Damage: bytes of the log that are replaced, and where it is cut.
fn damage() -> impl Strategy<Value = (Vec<(usize, u8)>, usize)> {
    (prop::collection::vec((0..4000usize, any::<u8>()), 0..12), 0..5000usize)
}

proptest! {
    #[test]
    fn any_bytes_are_read(data in prop::collection::vec(any::<u8>(), 0..300)) {
        check(&[start(), data].concat());
    }

    #[test]
    fn damaged_logs_are_read((bytes, end) in damage()) {
        let mut data = log(120);
        data.truncate(end);
        for (position, byte) in bytes {
            if let Some(target) = data.get_mut(position) {
                *target = byte;
            }
        }
        check(&data);
    }

    // The format has no checksums: damage that looks like the header of a message costs the size that it claims.
    // These bytes claim more than the log has, or, beside a byte of the log, at most `CLAIMED`.
    #[test]
    fn damage_costs_only_what_it_touches(at in 200..2000usize, junk in prop::collection::vec(0x80..=0xFFu8, 1..200)) {
        const CLAIMED: usize = 300;
        let good = log(120);
        let mut data = good.clone();
        let end = (at + junk.len()).min(data.len());
        data.splice(at..end, junk);
        let found = values(&build(&data), &data);
        for value in 0..120 {
            let position = position(&good, value);
            let untouched = position + 16 <= at || position >= end + CLAIMED;
            prop_assert!(!untouched || found.contains(&(value as u16)), "{value} of {found:?}");
        }
    }
}

#[test]
fn damaged_bytes_of_an_index_give_none_or_one_that_can_be_used() {
    let data = log(300);
    let header = Header::parse(&data).expect("a header");
    let saved = build(&data).save();
    for position in 0..saved.len() {
        assert!(Index::restore(&saved[..position], &data, &header).is_none());
        for value in [0, 1, 0x7F, 0xFF] {
            let mut changed = saved.clone();
            changed[position] = value;
            if let Some(index) = Index::restore(&changed, &data, &header) {
                summary(&index, &data);
                let _part = index.following(&data, 1000, Options::default());
            }
        }
    }
}
