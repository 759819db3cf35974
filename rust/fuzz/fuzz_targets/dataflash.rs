//! The index of a DataFlash log counts every byte, and does not fail on data that changed after indexing
//! or on an index that was saved and damaged.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mavstack_logs::dataflash::row::{Conversion, Field, HeaderField, Layout, Time};
use mavstack_logs::dataflash::{Index, Request};

/// A layout with a field of each kind, as far as records of this length have room for them.
fn layout(length: u8) -> Option<Layout> {
    let length = usize::from(length);
    let kinds = [(b'Q', 8, Conversion::Copy), (b'L', 4, Conversion::Scaled), (b'n', 4, Conversion::Text)];
    let (mut source, mut target, mut fields) = (3, 12, Vec::new());
    for (character, size, conversion) in kinds {
        if source + size <= length {
            fields.push(Field { character, conversion, source, target });
            source += size;
            target += 8;
        }
    }
    let field = |character, size: usize| (3 + size <= length).then_some(HeaderField { character, source: 3 });
    let time = field(b'Q', 8).map(|field| Time { field, factor: 1000, offset: 1 });
    Layout::new(length, target, &fields, time, field(b'B', 1))
}

fuzz_target!(|data: &[u8]| {
    let [choice, log @ ..] = data else { return };
    let index = Index::build(log, 1 + usize::from(choice & 3));
    let mut bytes = 0;
    for (slot, definition) in index.definitions().iter().enumerate() {
        bytes += index.rows(slot) * usize::from(definition.length);
        let layout = layout(definition.length).expect("a layout that fits");
        let mut rows = vec![0; index.rows(slot) * layout.row_size()];
        for data in [log, &log[..log.len() - log.len().min(usize::from(*choice))]] {
            index.decode(data, vec![Request { slot, first: 0, layout: &layout, rows: &mut rows }], 2);
        }
    }
    assert_eq!(bytes as u64 + index.damage().bad_bytes, log.len() as u64);
    let before = index.rows_before(log, log.len());
    assert!(before.iter().enumerate().all(|(slot, &rows)| rows == index.rows(slot)));
    let mut saved = index.save().expect("positions of all records");
    let restored = Index::restore(&saved, log).expect("the index that was saved");
    assert_eq!((restored.definitions(), restored.damage()), (index.definitions(), index.damage()));
    let place = log.iter().fold(0, |sum, &byte| (sum * 31 + usize::from(byte)) % 65_521) % saved.len();
    saved[place] ^= choice | 1;
    if let Some(damaged) = Index::restore(&saved, log) {
        let _rows = damaged.rows_before(log, log.len());
        let _fewer = damaged.without_positions().rows_before(log, log.len() / 2);
    }
});
