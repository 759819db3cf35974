//! The input of a node.
//!
//! [`intake::Intake`] has no sockets, threads or clocks. It splits datagrams into packets, keeps the latest packet of each
//! source and message, and queues the packets that the program waits for. A packet is only kept from the program if the
//! program granted its source on its channel and decided that no part of it waits for its message: all others are
//! queued. [`reader::Reader`] runs it on a thread over UDP sockets, several datagrams per system call.
#![forbid(unsafe_code)]

pub mod channel;
pub mod fields;
pub mod intake;
pub mod messages;
pub mod pace;
pub mod queue;
pub mod reader;
pub mod sockets;

#[cfg(test)]
mod tests;
