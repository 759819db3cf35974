//! Ports: places that packets come from and go to: a stream, a queue, or one peer of a socket. Each is a sender of its own.

/// Index of a port; indices of removed ports are used again.
pub type PortId = usize;

/// A set of ports.
pub use mavstack_core::index_set::IndexSet as PortSet;

/// Maximum number of ports of a router, so that a set has a bounded size.
pub const MAX_PORTS: usize = 4096;
