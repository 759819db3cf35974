//! The data plane of the router.
//!
//! [`router::Router`] decides where each packet goes; it has no sockets, threads or clocks. [`engine::Engine`] runs it on
//! one thread over sockets, streams and queues, with several packets per system call where the system allows it.
#![forbid(unsafe_code)]

pub mod addressing;
pub mod bucket;
pub mod counters;
mod duplicates;
pub mod endpoint;
pub mod engine;
pub mod event;
pub mod gateway;
mod held;
mod packet_hash;
pub mod ports;
pub mod router;
pub mod rules;

#[cfg(test)]
mod tests;
