use super::*;
use crate::dataflash::row::{Conversion, Field, HeaderField, Time};
use crate::dataflash::samples::{Log, random_log};
use crate::rows::NO_TIME;

/// Everything of an index that does not depend on the number of threads.
fn content(index: &Index, data: &[u8]) -> (Vec<Vec<u64>>, Damage, Vec<Redefinition>, Vec<Definition>) {
    let positions = (0..index.definitions().len()).map(|slot| {
        let mut positions = vec![0; index.rows(slot)];
        index.positions(data, slot, 0, &mut positions);
        positions
    });
    (positions.collect(), index.damage.clone(), index.redefinitions.clone(), index.definitions().to_vec())
}

fn layout() -> Layout {
    let fields = [
        Field { character: b'Q', conversion: Conversion::Copy, source: 3, target: 12 },
        Field { character: b'c', conversion: Conversion::Scaled, source: 12, target: 20 },
    ];
    Layout::new(14, 28, &fields, None, None).expect("a valid layout")
}

#[test]
fn several_threads_give_the_result_of_one() {
    for seed in 0..40 {
        let data = random_log(seed, 40 * SEGMENT);
        let one = Index::build(&data, 1);
        assert!(one.rows(1) > 300 && one.damage.bad_bytes > 0);
        for threads in [2, 3, 7, 100] {
            assert_eq!(content(&Index::build(&data, threads), &data), content(&one, &data), "seed {seed}");
        }
    }
}

#[test]
fn steps_give_the_result_of_one_and_cover_the_data() {
    for seed in 0..10 {
        let data = random_log(seed, 40 * SEGMENT);
        let one = Index::build(&data, 1);
        for (step, threads) in [(1, 1), (3 * SEGMENT, 2), (7 * SEGMENT + 5, 3)] {
            let mut covered = 0;
            let index = Index::build_in_steps(&data, threads, step, |part| {
                assert_eq!(part.start, covered);
                covered = part.end;
            });
            assert_eq!(covered, data.len());
            assert_eq!(content(&index, &data), content(&one, &data), "seed {seed}");
            assert_eq!(content(&index.without_positions(), &data), content(&one, &data), "seed {seed}");
        }
    }
}

#[test]
fn records_are_found_in_file_order() {
    let data = random_log(3, 10 * SEGMENT);
    let index = Index::build(&data, 3);
    let (positions, ..) = content(&index, &data);
    assert!(positions.iter().all(|positions| positions.is_sorted()));
    let mut walked = vec![Vec::new(); positions.len()];
    Walk::new(&data, Place::START, Formats::default())
        .run(data.len(), |record| walked[usize::from(record.slot)].push(record.start as u64));
    assert_eq!(positions, walked);
}

#[test]
fn segments_without_kept_positions_are_walked_again() {
    let data = random_log(1, 60 * SEGMENT);
    let index = Index::build(&data, 1);
    assert!(index.segments.iter().any(|segment| segment.offsets.is_none()), "the log has more records than are kept");
    assert!(index.segments.iter().any(|segment| segment.offsets.is_some()));
    let mut rows = vec![0; index.rows(1) * 28];
    let layout = layout();
    index.decode(&data, vec![Request { slot: 1, first: 0, layout: &layout, rows: &mut rows }], 3);
    let mut positions = vec![0; index.rows(1)];
    index.positions(&data, 1, 0, &mut positions);
    for (row, position) in rows.chunks(28).zip(positions) {
        let record = &data[position as usize..];
        assert_eq!(row[12..20], record[3..11]);
        let raw = i16::from_le_bytes([record[12], record[13]]);
        assert_eq!(row[20..28], (f64::from(raw) / 100.0).to_le_bytes());
    }
}

#[test]
fn parts_of_a_table_make_the_whole() {
    let data = random_log(7, 30 * SEGMENT);
    let index = Index::build(&data, 2);
    let layout = layout();
    let mut whole = vec![0; index.rows(1) * 28];
    index.decode(&data, vec![Request { slot: 1, first: 0, layout: &layout, rows: &mut whole }], 1);
    let mut parts = Vec::new();
    let mut before = vec![0; index.definitions().len()];
    for end in (0..=data.len() + 5000).step_by(5000) {
        let until = index.rows_before(&data, end);
        let mut rows = vec![0; (until[1] - before[1]) * 28];
        index.decode(&data, vec![Request { slot: 1, first: before[1], layout: &layout, rows: &mut rows }], 2);
        parts.extend(rows);
        before = until;
    }
    assert!(parts == whole);
    assert_eq!(before[1], index.rows(1));
    let mut some = [0; 10];
    index.positions(&data, 1, 300, &mut some);
    assert_eq!(some.to_vec(), content(&index, &data).0[1][300..310]);
}

#[test]
fn rows_before_counts_records_by_their_beginning() {
    let mut log = Log::with_types();
    let start = log.0.len();
    log.a(1, 0, 1).a(2, 0, 2).t(3, "x");
    let index = Index::build(&log.0, 1);
    for (position, rows) in [(start, 0), (start + 1, 1), (start + 14, 1), (start + 15, 2)] {
        assert_eq!(index.rows_before(&log.0, position), [2, rows, 0]);
    }
}

#[test]
fn data_that_changed_after_indexing_does_no_harm() {
    let data = random_log(11, 60 * SEGMENT);
    let index = Index::build(&data, 2);
    let layout = layout();
    for changed in [&data[..data.len() / 2], &random_log(12, 60 * SEGMENT)[..], &[]] {
        let mut rows = vec![0xAA; index.rows(1) * 28];
        index.decode(changed, vec![Request { slot: 1, first: 0, layout: &layout, rows: &mut rows }], 2);
        assert_eq!(index.rows_before(changed, 0)[1], 0);
        let _ = index.rows_before(changed, 30_000);
        let mut positions = vec![0; index.rows(1)];
        index.positions(changed, 1, 0, &mut positions);
    }
}

#[test]
fn a_saved_index_is_restored() {
    for seed in 0..20 {
        let data = random_log(seed, 20 * SEGMENT);
        let index = Index::build(&data, 3);
        let saved = index.save();
        let summary = Index::restore(&index.without_positions().save(), &data).expect("the summary that was saved");
        assert!(!summary.has_positions());
        assert_eq!(content(&summary, &data), content(&index, &data), "seed {seed}");
        let restored = Index::restore(&saved, &data).expect("the index that was saved");
        assert_eq!(content(&restored, &data), content(&index, &data), "seed {seed}");
        assert_eq!(content(&restored.without_positions(), &data), content(&index, &data), "seed {seed}");
        assert!(Index::restore(&saved, &data[..data.len() - 1]).is_none());
    }
}

#[test]
fn damaged_bytes_of_an_index_give_none_or_one_that_can_be_used() {
    let data = random_log(5, 2 * SEGMENT);
    let saved = Index::build(&data, 1).save();
    for position in 0..saved.len() {
        assert!(Index::restore(&saved[..position], &data).is_none());
        for value in [0, 1, 0x7F, 0xFF] {
            let mut changed = saved.clone();
            changed[position] = value;
            if let Some(index) = Index::restore(&changed, &data) {
                content(&index, &data);
                content(&index.without_positions(), &data);
                let mut rows = vec![0; index.rows(1) * layout().row_size()];
                index.decode(&data, vec![Request { slot: 1, first: 0, layout: &layout(), rows: &mut rows }], 1);
            }
        }
    }
}

/// A log of timed records (type 1, `T`) and records without a time (type 2, `E`).
fn mixed_log(time: impl Fn(u64) -> Option<u64>, count: u64) -> Vec<u8> {
    let mut log = Log::default();
    log.define(1, "T", "Q", "TimeUS", 11).define(2, "E", "B", "Id", 4);
    for number in 0..count {
        match time(number) {
            Some(time) => log.record(1, &time.to_le_bytes()),
            None => log.record(2, &[0]),
        };
    }
    log.0
}

#[test]
fn records_without_a_time_take_the_time_of_the_record_before_them() {
    let layout = Layout::new(
        11,
        12,
        &[],
        Some(Time { field: HeaderField { character: b'Q', source: 3 }, factor: 1, offset: 0 }),
        None,
    )
    .expect("a valid layout");
    let count = 5 * SEGMENT as u64 / 11;
    // The first record, and each seventh, has no time.
    let data = mixed_log(|number| (number % 7 != 0).then_some(1000 + number), count);
    for index in [Index::build(&data, 1), Index::build(&data, 3), Index::build(&data, 1).without_positions()] {
        let slot = index.definitions().iter().position(|each| each.name.starts_with(b"E")).expect("a slot");
        let other = index.definitions().iter().position(|each| each.name.starts_with(b"T")).expect("a slot");
        let mut times = vec![0; index.rows(slot)];
        index.neighbour_times(&data, slot, &[(other, &layout)], &mut times);
        let expected: Vec<_> = (0..count).step_by(7).map(|number| 1000 + number.max(2) as i64 - 1).collect();
        assert_eq!(times, expected);
        index.neighbour_times(&data, slot, &[], &mut times);
        assert!(times.iter().all(|&time| time == NO_TIME));
    }
}
