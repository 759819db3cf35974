//! Times of records that have none: the time of the record before them.
//!
//! Old firmware wrote events and errors without a time. The record before each in the log was written at about the
//! same time.

use super::format::Formats;
use super::row::Layout;
use super::segment::Segment;
use crate::rows::NO_TIME;

/// A definition with a time: its slot, and the layout that reads the time.
pub type Timed<'a> = (usize, &'a Layout);

/// Writes the time of the last timed record before each record of `slot`, by the record's number.
///
/// Records before all timed ones get the time of the first timed record after them; without any, [`NO_TIME`].
pub(super) fn neighbour_times(
    segments: &[Segment],
    formats: &Formats,
    data: &[u8],
    slot: usize,
    clocks: &[Timed<'_>],
    times: &mut [i64],
) {
    let mut times = times.iter_mut();
    let mut waiting = Vec::new();
    let mut last = None;
    for segment in segments {
        if times.len() == 0 && waiting.is_empty() {
            return;
        }
        let offsets = segment.offsets(data, formats);
        let before = |limit: u32| {
            let records = clocks.iter().filter_map(|&(slot, layout)| {
                let offsets = &offsets[segment.range(slot)];
                let count = offsets.partition_point(|&offset| offset < limit);
                Some((*offsets.get(count.checked_sub(1)?)?, layout))
            });
            let (offset, layout) = records.max_by_key(|&(offset, _)| offset)?;
            layout.time_at(data, segment.base() + offset as usize)
        };
        for (&offset, time) in offsets[segment.range(slot)].iter().zip(&mut times) {
            match before(offset).or(last) {
                Some(known) => *time = known,
                None => waiting.push(time),
            }
        }
        if !waiting.is_empty() {
            let records =
                clocks.iter().filter_map(|&(slot, layout)| Some((*offsets[segment.range(slot)].first()?, layout)));
            let first = records.min_by_key(|&(offset, _)| offset);
            if let Some(known) =
                first.and_then(|(offset, layout)| layout.time_at(data, segment.base() + offset as usize))
            {
                waiting.drain(..).for_each(|time| *time = known);
            }
        }
        last = before(u32::MAX).or(last);
    }
    for time in times.chain(waiting) {
        *time = NO_TIME;
    }
}
