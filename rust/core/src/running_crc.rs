//! CRCs of many overlapping ranges of one byte slice, in constant time per range.
//!
//! Bytes that are full of false magics are candidates for a packet at nearly every position, and each candidate spans up
//! to 280 bytes. The CRC is linear, so that the CRC of a range follows from the CRCs of the bytes before its start and
//! before its end. These are calculated once per byte, and kept for the last [`WINDOW`] bytes.

use crate::crc::{self, INITIAL};
use crate::header::MAX_PACKET;

/// Number of bytes whose CRCs are kept; a power of two, and longer than a packet.
const WINDOW: usize = 512;
const _: () = assert!(WINDOW > MAX_PACKET && WINDOW.is_power_of_two());

/// CRCs of all prefixes of a slice that end in its last [`WINDOW`] bytes, from the initial value 0.
#[derive(Debug)]
pub(crate) struct RunningCrc {
    prefixes: [u16; WINDOW],
    /// Index of the first byte whose prefix is known.
    first: usize,
    /// Index up to which the prefixes are calculated.
    end: usize,
}

impl RunningCrc {
    /// Creates a state without any prefix.
    pub(crate) fn new() -> Self {
        Self { prefixes: [0; WINDOW], first: 0, end: 0 }
    }

    /// Returns the CRC of `data[start..end]`, which must be shorter than [`WINDOW`].
    ///
    /// Ranges may overlap in any way; they cost constant time each if their starts mostly increase.
    pub(crate) fn of_range(&mut self, data: &[u8], start: usize, end: usize) -> u16 {
        if start < self.first || start > self.end {
            (self.first, self.end) = (start, start);
            self.prefixes[start % WINDOW] = 0;
        }
        if end > self.end {
            let mut prefix = self.prefixes[self.end % WINDOW];
            for (index, &byte) in data.iter().enumerate().take(end).skip(self.end) {
                prefix = crc::accumulate(prefix, byte);
                self.prefixes[(index + 1) % WINDOW] = prefix;
            }
            self.end = end;
            self.first = self.first.max((end + 1).saturating_sub(WINDOW));
        }
        let before = self.prefixes[start % WINDOW] ^ INITIAL;
        self.prefixes[end % WINDOW] ^ crc::append_zeros(before, end - start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_the_crc_of_each_range(
            data in prop::collection::vec(any::<u8>(), 1..2000),
            ranges in prop::collection::vec((0usize..2000, 0usize..MAX_PACKET), 1..50),
        ) {
            let mut running = RunningCrc::new();
            for (start, length) in ranges {
                let start = start.min(data.len());
                let end = (start + length).min(data.len());
                prop_assert_eq!(running.of_range(&data, start, end), crc::update(INITIAL, &data[start..end]));
            }
        }
    }
}
