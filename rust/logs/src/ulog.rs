//! PX4's log format ULog: a header, then messages of a size (u16), a kind (one character) and a body.
//!
//! The format describes itself: 'F' defines a record with named fields, 'A' gives a topic and an instance of it a
//! number, and 'D' is a record of that number. No checksum protects a message. [`scan`] therefore assesses each message by
//! its kind, its size and its successors, and after damage searches for the next place where messages follow each
//! other. Its decisions depend only on the bytes and on the known subscriptions, so that threads can start in the middle
//! of a file; [`index`] proves each start correct or discards it. A record becomes a row of its topic's table by copying
//! the bytes of its fields.

pub mod catalog;
pub mod decode;
pub mod header;
pub mod index;
pub mod layout;
mod saved;
pub mod scan;

#[cfg(test)]
mod tests;

/// Reads a little-endian u16.
fn u16_at(data: &[u8], position: usize) -> Option<u16> {
    data.get(position..)?.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
}

/// Reads a little-endian u64.
fn u64_at(data: &[u8], position: usize) -> Option<u64> {
    data.get(position..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}
