//! `mavstack._core`: the thin layer between `mavstack-core` and Python.
//!
//! All classes are safe PyO3 except packets ([`packet`], [`freelist`]) and messages ([`message`], [`construct`],
//! [`class`], [`fields`]), whose objects have a layout of their own: each is one allocation, an object header followed
//! by its bytes.

mod buffers;
mod claims;
mod class;
mod construct;
mod dataflash;
mod datagrams;
mod dialect;
mod encode;
mod errors;
mod fields;
mod freelist;
mod index;
mod intake;
mod intake_listeners;
mod intake_made;
mod intake_values;
mod interpreter;
mod json;
mod keywords;
mod mapping_guard;
mod memory;
mod message;
mod packet;
mod packet_getters;
mod packet_router;
mod parser;
mod records;
mod router;
mod router_descriptors;
mod router_events;
mod router_rules;
mod router_statistics;
mod signing;
mod statistics;
mod steps;
mod swarm;
mod ulog;
mod values;

use buffers::Bytes;
use pyo3::prelude::*;

/// Calculate the CRC-16/MCRF4XX of `data`, the checksum of MAVLink packets.
///
/// Args:
///     data: The bytes to add to the checksum.
///     crc: The checksum to continue from; by default the initial value 0xFFFF.
///
/// Returns:
///     The checksum, 0 to 0xFFFF.
#[pyfunction]
#[pyo3(signature = (data, crc = mavstack_core::crc::INITIAL))]
fn crc16(data: Bytes<'_>, crc: u16) -> u16 {
    mavstack_core::crc::update(crc, &data)
}

// The free lists need the interpreter lock: a free-threaded Python turns it on when it imports the core.
#[pymodule(gil_used = true)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    interpreter::require_main(py)?;
    module.add_class::<dialect::Dialect>()?;
    module.add("Packet", packet::packet_class(py)?)?;
    module.add_class::<parser::Parser>()?;
    module.add_class::<encode::Encoder>()?;
    encode::install_fast_encode(py)?;
    module.add_class::<signing::Signing>()?;
    module.add_class::<statistics::Statistics>()?;
    module.add_class::<statistics::SourceStatistics>()?;
    module.add_class::<statistics::Refusals>()?;
    module.add_class::<index::Index>()?;
    module.add_class::<mapping_guard::MappingGuard>()?;
    module.add_class::<index::WindowIndexer>()?;
    module.add_class::<dataflash::DataFlashIndex>()?;
    module.add_class::<dataflash::DataFlashLayout>()?;
    module.add_class::<ulog::UlogIndex>()?;
    module.add_class::<claims::Claims>()?;
    module.add_class::<intake::Intake>()?;
    module.add_class::<datagrams::DatagramSender>()?;
    module.add_class::<router::RouterCore>()?;
    module.add_class::<packet_router::PacketRouter>()?;
    module.add("MessageMeta", class::metaclass(py)?)?;
    module.add("MessageBase", message::base_class(py)?)?;
    module.add("TOOLCHAIN", env!("MAVSTACK_TOOLCHAIN"))?;
    module.add_function(wrap_pyfunction!(crc16, module)?)?;
    module.add_function(wrap_pyfunction!(class::new_message_class, module)?)?;
    module.add_function(wrap_pyfunction!(encode::encode, module)?)?;
    module.add_function(wrap_pyfunction!(json::fields_json, module)?)?;
    module.add_function(wrap_pyfunction!(index::looks_timestamped, module)?)?;
    module.add_function(wrap_pyfunction!(swarm::avoiding_velocities, module)?)?;
    Ok(())
}
