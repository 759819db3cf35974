//! Indexing a file piece by piece, in memory that does not grow with the file.
//!
//! The state of the scanner is carried from one piece to the next, so the packets are those of the whole file, wherever
//! it is cut.

use crate::bulk::{Index, Source};
use crate::layout::Dialect;
use crate::scan::State;

/// Indexes the pieces of one file, and adds up their totals.
#[derive(Debug, Default)]
pub struct Indexer {
    timestamped: bool,
    state: State,
    totals: Index,
    rows: Vec<usize>,
}

impl Indexer {
    /// Creates an indexer; `timestamped` is for a file with an 8-byte timestamp before each packet (a tlog).
    #[must_use]
    pub fn new(timestamped: bool) -> Self {
        Self { timestamped, ..Self::default() }
    }

    /// Indexes the complete packets of the next piece, which begins with the bytes left over from the previous one.
    ///
    /// Returns their index, and the number of bytes that are done with; the others are the beginning of the next piece.
    pub fn next(&mut self, data: &[u8], dialect: &Dialect, at_end: bool, threads: usize) -> (Index, usize) {
        let source = Source { data, dialect, timestamped: self.timestamped, at_end };
        let (mut index, state) = Index::build_from(source, self.state, threads);
        let done = state.first_needed(self.timestamped).min(data.len());
        index.add_bad_bytes(done.saturating_sub(state.boundary));
        self.state = state.after_removing(done);
        self.totals.append_totals(&index);
        self.rows.resize(dialect.layouts().len(), 0);
        for (slot, rows) in self.rows.iter_mut().enumerate() {
            *rows += index.rows(slot);
        }
        (index, done)
    }

    /// Totals of all pieces so far; the index has no rows.
    #[must_use]
    pub fn totals(&self) -> &Index {
        &self.totals
    }

    /// Number of packets of the layout in `slot` so far.
    #[must_use]
    pub fn rows(&self, slot: usize) -> usize {
        self.rows.get(slot).copied().unwrap_or(0)
    }
}

#[cfg(test)]
#[path = "windows_tests.rs"]
mod tests;
