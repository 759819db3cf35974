//! ArduPilot's onboard logs (`.BIN`), which describe themselves.
//!
//! A record is two header bytes, a type number and a body without length, checksum or end mark. The length and the
//! fields of a type stand in an FMT record, which precedes the first record of its type and may be followed by another
//! FMT record that changes the meaning of the number. Reading therefore means walking from record to record
//! ([`scan`]), with the types known so far ([`format`]); the positions found become rows of tables ([`index`],
//! [`row`]).

pub mod format;
pub mod index;
mod neighbours;
pub mod row;
#[cfg(test)]
mod samples;
mod saved;
pub mod scan;
mod segment;

pub use index::{Index, Request};
pub use neighbours::Timed;
