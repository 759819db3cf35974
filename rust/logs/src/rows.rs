//! The beginning of every row.
//!
//! A row begins with its time and the instance of its sensor; the fields of the record follow.

/// Bytes of a row before the fields: time in microseconds (8), instance, three zero bytes.
pub const ROW_HEADER: usize = 12;
/// Position of the instance in a row.
pub const INSTANCE: usize = 8;
/// Time of a row without a known time: numpy's `NaT`.
pub const NO_TIME: i64 = i64::MIN;
