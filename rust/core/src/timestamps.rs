//! The 8 bytes before each packet of a timestamped stream: big-endian microseconds since 1970.
//!
//! Some old recorders wrote them in little-endian order. Which order is meant is seen by the year.

use std::ops::Range;

pub const TIMESTAMP: usize = 8;

/// Plausible timestamps: the years 2000 to 2099 in microseconds since 1970.
const PLAUSIBLE_TIMES: Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// Decodes a timestamp to microseconds since 1970, in the order of bytes that gives a plausible time.
#[inline]
#[must_use]
pub fn timestamp_microseconds(stamp: [u8; TIMESTAMP]) -> u64 {
    let (big, little) = (u64::from_be_bytes(stamp), u64::from_le_bytes(stamp));
    if !PLAUSIBLE_TIMES.contains(&big) && PLAUSIBLE_TIMES.contains(&little) { little } else { big }
}

/// Returns whether the last bytes of `data` are a plausible time: after junk they may be junk too.
pub(crate) fn ends_with_plausible_time(data: &[u8]) -> bool {
    let stamp = data.last_chunk::<TIMESTAMP>();
    stamp.is_some_and(|stamp| PLAUSIBLE_TIMES.contains(&timestamp_microseconds(*stamp)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_bytes_is_that_of_a_plausible_time() {
        let time: u64 = 1_700_000_000_000_000;
        assert_eq!(timestamp_microseconds(time.to_be_bytes()), time);
        assert_eq!(timestamp_microseconds(time.to_le_bytes()), time);
        assert_eq!(timestamp_microseconds(5u64.to_be_bytes()), 5, "times since boot stay as they are");
    }

    #[test]
    fn only_complete_times_are_plausible() {
        let time: [u8; TIMESTAMP] = 1_700_000_000_000_000_u64.to_be_bytes();
        assert!(ends_with_plausible_time(&time));
        assert!(ends_with_plausible_time(&[&[1, 2, 3], time.as_slice()].concat()));
        assert!(!ends_with_plausible_time(&time[1..]));
        assert!(!ends_with_plausible_time(&5u64.to_be_bytes()));
    }
}
