use super::*;
use crate::dataflash::samples::Log;
use proptest::prelude::*;

fn field(character: u8, conversion: Conversion, source: usize, target: usize) -> Field {
    Field { character, conversion, source, target }
}

fn header_field(character: u8, source: usize) -> HeaderField {
    HeaderField { character, source }
}

/// The row of one record.
fn row(layout: &Layout, record: &[u8]) -> Vec<u8> {
    let mut row = vec![0xAA; layout.row_size()];
    layout.decode(record, &[0], &mut row);
    row
}

#[test]
fn the_header_has_time_and_instance() {
    let mut log = Log::default();
    log.a(5_000_000, 3, 0);
    let time = Time { field: header_field(b'Q', 3), factor: 1, offset: 1_700_000_000_000_000 };
    let layout = Layout::new(14, 12, &[], Some(time), Some(header_field(b'B', 11))).expect("valid");
    let row = row(&layout, &log.0);
    assert_eq!(row[..8], 1_700_000_005_000_000i64.to_le_bytes());
    assert_eq!(row[8..], [3, 0, 0, 0]);
}

#[test]
fn an_impossible_time_is_not_a_time() {
    for (raw, factor) in [(u64::MAX, 1), (i64::MAX as u64, 1), (i64::MAX as u64 / 2, 1000)] {
        let mut log = Log::default();
        log.a(raw, 0, 0);
        let time = Time { field: header_field(b'Q', 3), factor, offset: 1 };
        let layout = Layout::new(14, 12, &[], Some(time), None).expect("valid");
        assert_eq!(row(&layout, &log.0)[..8], NO_TIME.to_le_bytes());
    }
}

#[test]
fn instances_beyond_a_byte_are_clamped() {
    let record = [0xA3, 0x95, 1, 0xFF, 0xFF];
    for (character, instance) in [(b'b', 0), (b'h', 0), (b'H', 255), (b'B', 255)] {
        let layout = Layout::new(5, 12, &[], None, Some(header_field(character, 3))).expect("valid");
        assert_eq!(row(&layout, &record)[8], instance, "as {}", char::from(character));
    }
}

#[test]
fn scaled_integers_are_divided_as_doubles() {
    let record = [0xA3, 0x95, 1, 0xC7, 0xCF, 0xFF, 0xFF];
    for (character, value) in [
        (b'c', f64::from(-12345i16) / 100.0),
        (b'C', f64::from(53191u16) / 100.0),
        (b'e', f64::from(-12345i32) / 100.0),
        (b'E', f64::from(4_294_954_951u32) / 100.0),
        (b'L', f64::from(-12345i32) / 1e7),
    ] {
        let layout = Layout::new(7, 20, &[field(character, Conversion::Scaled, 3, 12)], None, None).expect("valid");
        assert_eq!(row(&layout, &record)[12..], value.to_le_bytes(), "as {}", char::from(character));
    }
}

#[test]
fn texts_end_at_their_nul() {
    let mut log = Log::default();
    log.t(1, "hi\0junk");
    let layout = |conversion| Layout::new(27, 28, &[field(b'N', conversion, 11, 12)], None, None).expect("valid");
    assert_eq!(row(&layout(Conversion::Text), &log.0)[12..], *b"hi\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    assert_eq!(row(&layout(Conversion::Copy), &log.0)[12..19], *b"hi\0junk");
}

#[test]
fn neighbouring_fields_are_copied_together() {
    let fields = [field(b'B', Conversion::Copy, 3, 12), field(b'H', Conversion::Copy, 4, 13)];
    let layout = Layout::new(6, 16, &fields, None, None).expect("valid");
    assert_eq!(layout.steps.len(), 1);
    assert_eq!(row(&layout, &[0xA3, 0x95, 1, 7, 8, 9])[12..], [7, 8, 9, 0], "the padding is zero");
}

#[test]
fn fields_outside_of_the_record_or_the_row_are_refused() {
    let valid = |fields: &[Field], instance| Layout::new(14, 28, fields, None, instance).is_some();
    assert!(valid(&[field(b'Q', Conversion::Copy, 6, 20)], None));
    assert!(!valid(&[field(b'Q', Conversion::Copy, 7, 20)], None));
    assert!(!valid(&[field(b'Q', Conversion::Copy, 6, 21)], None));
    assert!(!valid(&[field(b'c', Conversion::Scaled, 3, 21)], None));
    assert!(!valid(&[field(b'Q', Conversion::Scaled, 3, 12)], None));
    assert!(!valid(&[field(b'?', Conversion::Copy, 3, 12)], None));
    assert!(!valid(&[field(b'Q', Conversion::Copy, usize::MAX, 12)], None));
    assert!(!valid(&[], Some(header_field(b'H', 13))));
    assert!(!valid(&[], Some(header_field(b'f', 3))));
    assert!(Layout::new(14, 11, &[], None, None).is_none());
    assert!(Layout::new(256, 28, &[], None, None).is_none());
}

#[test]
fn records_that_are_no_longer_in_the_data_are_zero() {
    let mut log = Log::default();
    log.a(1, 2, 3).cut(1);
    let layout = Layout::new(14, 20, &[field(b'Q', Conversion::Copy, 3, 12)], None, Some(header_field(b'B', 11)));
    let row = row(&layout.expect("valid"), &log.0);
    assert_eq!(row[..8], NO_TIME.to_le_bytes());
    assert!(row[8..].iter().all(|&byte| byte == 0));
}

proptest! {
    #[test]
    fn each_row_is_the_conversion_of_its_record(values in prop::collection::vec(any::<(u64, u8, i16)>(), 0..300)) {
        let mut log = Log::default();
        for &(time, instance, value) in &values {
            log.a(time, instance, value);
        }
        let fields = [field(b'Q', Conversion::Copy, 3, 12), field(b'c', Conversion::Scaled, 12, 20)];
        let layout = Layout::new(14, 28, &fields, None, Some(header_field(b'B', 11))).expect("valid");
        let offsets: Vec<u32> = (0..values.len() as u32).map(|number| number * 14).collect();
        let mut rows = vec![0xAA; values.len() * 28];
        layout.decode(&log.0, &offsets, &mut rows);
        for (row, (time, instance, value)) in rows.chunks(28).zip(values) {
            prop_assert_eq!(row[8], instance);
            prop_assert_eq!(&row[12..20], &time.to_le_bytes());
            prop_assert_eq!(&row[20..], &(f64::from(value) / 100.0).to_le_bytes());
        }
    }
}
