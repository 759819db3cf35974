//! The MAVLink wire protocol, driven by layout tables that are handed in at run time.
//!
//! Nothing here knows Python, sockets, files or clocks: bytes and times are arguments. The one idea the
//! rest hangs on is [`scan::Scanner`]: it walks a byte slice and yields what is a packet. The push
//! [`parser::Parser`] and the bulk decoder in [`bulk`] are two ways of driving it.
#![forbid(unsafe_code)]

pub mod bulk;
pub mod crc;
pub mod encode;
pub mod header;
pub mod layout;
pub mod parser;
pub mod scan;
pub mod sequence;
pub mod signing;
pub mod statistics;
