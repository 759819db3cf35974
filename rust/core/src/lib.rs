//! The MAVLink wire protocol, driven by layout tables that are passed in at run time.
//!
//! The crate does not depend on Python, sockets, files or clocks: bytes and times are arguments. Its central type is
//! [`scan::Scanner`], which walks a byte slice and yields the packets in it. The push [`parser::Parser`] and the bulk
//! decoder in [`bulk`] are its two users.
#![forbid(unsafe_code)]

pub mod bulk;
pub mod claims;
pub mod crc;
pub mod encode;
pub mod header;
pub mod index_set;
pub mod jobs;
pub mod json;
pub mod layout;
pub mod parser;
mod running_crc;
pub mod saved;
pub mod scan;
pub mod sequence;
pub mod signing;
pub mod statistics;
pub mod timestamps;
pub mod windows;
