//! Onboard logs of autopilots: an index of a file's records, and their conversion to rows of tables.
//!
//! The crate does not depend on Python, files or clocks: a log is a byte slice, which may hold anything. Each format is
//! one module.
#![forbid(unsafe_code)]

pub mod dataflash;
pub mod rows;
pub mod ulog;
