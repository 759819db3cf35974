use super::*;
use crate::bulk::row_size;
use crate::bulk::tests::log;
use crate::layout::tests::dialect;
use crate::parser::tests::piece;
use proptest::prelude::*;

/// Decodes each slot of an index.
fn tables(index: &Index, data: &[u8]) -> Vec<Vec<u8>> {
    let dialect = dialect();
    let sizes = dialect.layouts().iter().enumerate().map(|(slot, layout)| index.rows(slot) * row_size(layout));
    let mut tables: Vec<_> = sizes.map(|size| vec![0; size]).collect();
    let buffers = tables.iter_mut().map(Vec::as_mut_slice).enumerate().collect();
    index.decode(data, &dialect, buffers, 1);
    tables
}

fn assert_windows_equal_the_whole(data: &[u8], timestamped: bool, size: usize, threads: usize) {
    let dialect = dialect();
    let whole = Index::build(data, &dialect, timestamped, 1);
    let mut indexer = Indexer::new(timestamped);
    let mut joined: Vec<Vec<u8>> = vec![Vec::new(); dialect.layouts().len()];
    let (mut start, mut end) = (0, 0);
    loop {
        end = data.len().min(end + size);
        let window = &data[start..end];
        let (index, done) = indexer.next(window, &dialect, end == data.len(), threads);
        for (all, table) in joined.iter_mut().zip(tables(&index, window)) {
            all.extend(table);
        }
        start += done;
        if end == data.len() {
            break;
        }
    }
    assert_eq!(joined, tables(&whole, data));
    assert_eq!(indexer.totals().statistics(), whole.statistics());
    assert_eq!(indexer.totals().unknown(), whole.unknown());
    assert_eq!(indexer.totals().time_span(), whole.time_span());
    let counts = |index: &Index| -> Vec<_> {
        index.sources().all().iter().map(|(s, c, x)| (*s, *c, x.received, x.bytes, x.lost, x.late)).collect()
    };
    assert_eq!(counts(indexer.totals()), counts(&whole));
    for slot in 0..dialect.layouts().len() {
        assert_eq!(indexer.rows(slot), whole.rows(slot));
    }
}

#[test]
fn large_windows_on_several_threads() {
    let data = log(0);
    for (size, threads) in [(data.len(), 2), (5 << 19, 3), (100_003, 1)] {
        assert_windows_equal_the_whole(&data, true, size, threads);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn small_windows_of_damaged_logs(
        pieces in prop::collection::vec(piece(), 0..20), timestamped: bool, size in 1usize..400
    ) {
        assert_windows_equal_the_whole(&pieces.concat(), timestamped, size, 1);
    }
}
