//! The bulk decoder finds the same packets as the push parser, and does not fail on data that changed after indexing
//! or on an index that was saved and damaged.
#![no_main]

use fuzz_dialect::{dialect, stream};
use libfuzzer_sys::fuzz_target;
use mavstack_core::bulk::{Index, row_size};
use mavstack_core::parser::Parser;
use mavstack_core::scan::looks_timestamped;

fuzz_target!(|data: &[u8]| {
    let [choice, plan @ ..] = data else { return };
    let dialect = dialect();
    let composed = if choice & 4 == 4 { stream(plan, &dialect) } else { plan.to_vec() };
    let stream = composed.as_slice();
    let timestamped = if choice & 2 == 2 { looks_timestamped(stream, &dialect) } else { choice & 1 == 1 };
    let index = Index::build(stream, &dialect, timestamped, 2);
    let mut parser = Parser::new(timestamped);
    parser.feed(&dialect, stream, |_| {});
    parser.flush(&dialect, |_| {});
    assert_eq!(index.statistics(), parser.statistics());
    let changed = &stream[..stream.len() - stream.len().min(usize::from(*choice))];
    for (slot, layout) in dialect.layouts().iter().enumerate() {
        let mut rows = vec![0; index.rows(slot) * row_size(layout)];
        index.decode(stream, &dialect, vec![(slot, &mut rows)], 2);
        index.decode(changed, &dialect, vec![(slot, &mut rows)], 2);
    }
    let mut saved = index.save(&dialect);
    let restored = Index::restore(&saved, &dialect, stream.len()).expect("the index that was saved");
    assert_eq!(restored.statistics(), index.statistics());
    for (position, value) in plan.iter().enumerate() {
        let place = (position * 7919 + usize::from(*value)) % saved.len();
        saved[place] ^= value;
    }
    if let Some(damaged) = Index::restore(&saved, &dialect, stream.len()) {
        for (slot, layout) in dialect.layouts().iter().enumerate() {
            let mut rows = vec![0; damaged.rows(slot) * row_size(layout)];
            damaged.decode(stream, &dialect, vec![(slot, &mut rows)], 2);
        }
    }
});
