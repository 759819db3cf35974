//! Python interface of the input of a node; see `mavstack.node.native_input`.

use crate::buffers::Bytes;
use crate::dialect::{AnyDialect, Dialect};
use crate::intake_listeners::Listeners;
use crate::intake_made::MadePackets;
use crate::intake_values::{
    LastBoot, Run, datagrams, interest, peer, to_activity, to_boot, to_heading, to_position, to_run,
};
use crate::packet;
use crate::parser::Parser;
use crate::router_descriptors::{stream_of, udp_of};
use mavstack_core::parser::Packet;
use mavstack_intake::channel::Boot;
use mavstack_intake::fields::Fields;
use mavstack_intake::intake as core;
use mavstack_intake::messages::{Decision, key};
use mavstack_intake::queue::Item;
use mavstack_intake::reader::Reader;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Runs, datagrams, messages to decide about, sockets and streams that the program must read, and whether it is to read
/// all.
type Taken<'py> = (Vec<Run<'py>>, Vec<Bound<'py, PyTuple>>, Vec<((u8, u8), u32)>, Vec<(u32, i32)>, bool);

/// The input of a node: a thread that reads sockets and streams, and the latest packet of each source and message.
///
/// A packet is kept from the program if its source was granted on its channel and the program decided that no part of
/// it waits for its message; all others wait in a queue. The latest packets are kept of systems that are followed.
///
/// Args:
///     dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
///     boot_fields: The offset of the boot time in the payload of each message that has one, by message id.
///     position_fields: The id of the message with a position, and the offsets of its latitude, longitude and speeds to
///         north and east.
///     heading_fields: The id of the message with an attitude, and the offsets of its roll, pitch, yaw and yaw speed.
#[pyclass(frozen, module = "mavstack._core")]
pub struct Intake {
    dialect: Py<Dialect>,
    core: Arc<Mutex<core::Intake>>,
    reader: Mutex<Option<Reader>>,
    made: MadePackets,
    /// The functions of the listeners of each source and message.
    listeners: Listeners,
}

fn running(reader: Option<&Reader>) -> PyResult<&Reader> {
    reader.ok_or_else(|| PyRuntimeError::new_err("the thread does not run"))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[pymethods]
impl Intake {
    #[new]
    fn new(
        dialect: AnyDialect,
        boot_fields: HashMap<u32, usize>,
        position_fields: [usize; 5],
        heading_fields: [usize; 5],
    ) -> Self {
        let (position, heading) = (to_position(position_fields), to_heading(heading_fields));
        let core =
            core::Intake::new(Arc::clone(&dialect.0.get().core), Fields { boot: boot_fields, position, heading });
        let core = Arc::new(Mutex::new(core));
        let (reader, made, listeners) = (Mutex::default(), MadePackets::default(), Listeners::default());
        Self { dialect: dialect.0, core, reader, made, listeners }
    }

    /// Start the thread; return a descriptor that is readable while something waits.
    ///
    /// Args:
    ///     now: The time of the program's clock in seconds.
    ///
    /// Raises:
    ///     OSError: The system has no more threads or descriptors.
    fn start(&self, now: f64) -> PyResult<i64> {
        let reader = Reader::start(Arc::clone(&self.core), now)?;
        let descriptor = reader.descriptor();
        *lock(&self.reader) = Some(reader);
        Ok(descriptor)
    }

    /// End the thread, and drop the packets that wait. Idempotent.
    fn stop(&self, py: Python<'_>) {
        let reader = lock(&self.reader).take();
        py.detach(|| drop(reader));
        lock(&self.core).queue.clear();
    }

    /// Read a UDP socket, whose descriptor is duplicated, from now on.
    ///
    /// Args:
    ///     socket: The number of the socket, chosen by the program.
    ///     descriptor: The descriptor.
    ///
    /// Raises:
    ///     OSError: The descriptor is not open.
    ///     RuntimeError: The thread does not run.
    fn add_socket(&self, socket: u32, descriptor: i64) -> PyResult<()> {
        let copy = udp_of(descriptor)?;
        Ok(running(lock(&self.reader).as_ref())?.add(socket, copy)?)
    }

    /// Read a stream, whose descriptor is duplicated, from now on, for a channel that was given to `attach_fed`.
    ///
    /// It is not read while too many packets wait, so that the system slows down its sender. When it ends, `take`
    /// returns its number after its last packet.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///     descriptor: The descriptor of a connection or a serial port.
    ///     is_terminal: It is a serial port or another terminal.
    ///
    /// Raises:
    ///     OSError: The descriptor is not open, or the system cannot wait for it.
    ///     RuntimeError: The thread does not run.
    fn add_stream(&self, channel: u32, descriptor: i64, is_terminal: bool) -> PyResult<()> {
        let copy = stream_of(descriptor)?;
        Ok(running(lock(&self.reader).as_ref())?.add_stream(channel, copy, is_terminal)?)
    }

    /// Read a socket or stream no more; its copy is closed when the call returns. Idempotent.
    ///
    /// Args:
    ///     socket: The number of the socket, or of the stream's channel.
    fn remove_socket(&self, py: Python<'_>, socket: u32) {
        py.detach(|| {
            if let Some(reader) = &*lock(&self.reader) {
                reader.remove(socket);
            }
        });
    }

    /// Let no packet rest for some time, because the program waits for an answer.
    ///
    /// Args:
    ///     seconds: The time.
    ///
    /// Returns:
    ///     True if the program is to wait for the sockets itself from now on, and to call `take` if one has something.
    fn hurry(&self, seconds: f64) -> bool {
        lock(&self.reader).as_ref().is_some_and(|reader| reader.hurry(seconds))
    }

    /// Parse the datagrams of a peer, from the oldest of those that wait for the program.
    ///
    /// Args:
    ///     channel: The number of the channel, chosen by the program.
    ///     socket: The number of its socket.
    ///     address: The address of the peer; port 0: any port of the host.
    ///     parser: The parser of the channel, which both use.
    ///
    /// Returns:
    ///     False if the host is not an IP address: its datagrams go on to the program.
    fn attach(
        &self,
        channel: u32,
        socket: u32,
        address: &Bound<'_, PyTuple>,
        parser: PyRef<'_, Parser>,
    ) -> PyResult<bool> {
        let Some(peer) = peer(address)? else {
            return Ok(false);
        };
        lock(&self.core).attach(channel, socket, peer, Arc::clone(&parser.core));
        Ok(true)
    }

    /// Parse what `feed` gives of a channel that the program reads itself.
    ///
    /// Args:
    ///     channel: The number of the channel, chosen by the program.
    ///     parser: The parser of the channel, which both use.
    fn attach_fed(&self, channel: u32, parser: PyRef<'_, Parser>) {
        lock(&self.core).attach_fed(channel, Arc::clone(&parser.core));
    }

    /// Parse bytes that the program received on a channel; `take` returns the packets.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///     data: The bytes.
    ///     now: The time of their arrival in seconds.
    ///
    /// Returns:
    ///     True if there is a valid packet among them.
    fn feed(&self, channel: u32, data: Bytes<'_>, now: f64) -> bool {
        lock(&self.core).feed(channel, &data, now)
    }

    /// Give the datagrams of a channel to the program from now on. Idempotent.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///
    /// Returns:
    ///     What was received since the last call, as `activity` does.
    fn detach(&self, channel: u32) -> (u64, u64, f64, f64) {
        to_activity(lock(&self.core).detach(channel))
    }

    /// Return the activity of a channel since the last call.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///
    /// Returns:
    ///     Bytes, datagrams, and the times of the last datagram and of the last valid packet; 0: none.
    fn activity(&self, channel: u32) -> (u64, u64, f64, f64) {
        to_activity(lock(&self.core).take_activity(channel))
    }

    /// Let packets of a source on a channel be kept from the program, from the oldest one that waits for it.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///     source: System and component id.
    ///
    /// Returns:
    ///     False if the intake does not parse that channel.
    fn grant(&self, channel: u32, source: (u8, u8)) -> bool {
        lock(&self.core).grant(channel, source)
    }

    /// Give every packet of a source to the program again.
    ///
    /// Args:
    ///     source: System and component id.
    ///
    /// Returns:
    ///     The channels on which it was granted, with the times of its last packets, 0: none, and with its last expected
    ///     boot times as `boot` returns them.
    fn revoke(&self, source: (u8, u8)) -> Vec<(u32, f64, LastBoot)> {
        let revoked = lock(&self.core).revoke(source).into_iter();
        revoked.map(|(channel, state)| (channel, state.heard_at, to_boot(state.boot))).collect()
    }

    /// Give every packet to the program again.
    fn revoke_all(&self) {
        lock(&self.core).revoke_all();
    }

    /// Set or take back the boot time that the next packets of a granted source have if it does not reboot.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///     source: System and component id.
    ///     boot: The boot time in milliseconds, and the time of its packet; None takes it back.
    fn expect_boot(&self, channel: u32, source: (u8, u8), boot: Option<(u32, f64)>) {
        let boot = boot.map(|(boot_ms, now)| Boot::new(boot_ms, now));
        lock(&self.core).expect_boot(channel, source, boot);
    }

    /// Return the last expected boot time of a granted source, in milliseconds, and the time of its packet; None if none
    /// is expected.
    ///
    /// Args:
    ///     channel: The number of the channel.
    ///     source: System and component id.
    fn boot(&self, channel: u32, source: (u8, u8)) -> LastBoot {
        to_boot(lock(&self.core).boot(channel, source))
    }

    /// Return the granted sources: channel, source, time of the last packet or 0, and what `boot` returns.
    fn sources(&self) -> Vec<(u32, (u8, u8), f64, LastBoot)> {
        let core = lock(&self.core);
        core.sources().map(|(channel, source, state)| (channel, source, state.heard_at, to_boot(state.boot))).collect()
    }

    /// Decide who takes a message of a source.
    ///
    /// Args:
    ///     source: System and component id.
    ///     message_id: The message id.
    ///     level: The interest of services; 0: not known, 1: none, 2: in boot times, positions and headings that do not
    ///         continue those before, 3: in every packet, soon, 4: in every packet, at once.
    ///     listeners: The functions that `deliver` calls with every packet.
    ///
    /// Raises:
    ///     ValueError: There is no such level.
    fn decide(&self, source: (u8, u8), message_id: u32, level: u8, listeners: Bound<'_, PyTuple>) -> PyResult<()> {
        let decision = Decision { interest: interest(level)?, is_listened: !listeners.is_empty() };
        self.listeners.set(key(source.0, source.1, message_id), listeners);
        lock(&self.core).messages.decide(source, message_id, decision);
        Ok(())
    }

    /// Forget the decisions about a message.
    ///
    /// Args:
    ///     message_id: The message id; None: all.
    ///     system: The system id; 0: all.
    fn forget_decisions(&self, message_id: Option<u32>, system: u8) {
        lock(&self.core).messages.forget_interest(message_id, system);
        self.listeners.forget(message_id, system);
    }

    /// Remove and return the packets and datagrams that wait, after the sockets were read if the program is to do so.
    ///
    /// Returns:
    ///     The packets, in order, as (channel, those for the engine, those for listeners, kept as latest packets already;
    ///     of those that are not kept the listeners are not known); the datagrams of senders that the intake does not
    ///     parse, as (socket, address, data, number of datagrams); the messages to `decide` about, as (source, message
    ///     id); the sockets that the program must read itself from now on, because it did not keep up, and the streams,
    ///     because they ended, each with the number of the error or 0; and whether the program is to wait for the other
    ///     ones from now on, as `hurry` returns it.
    fn take<'py>(&self, py: Python<'py>) -> PyResult<Taken<'py>> {
        let is_direct = lock(&self.reader).as_ref().is_some_and(Reader::begin_to_take);
        let (taken, undecided, is_waiting) = {
            let mut core = lock(&self.core);
            if core.messages.take_decided() {
                core.drop_unwanted();
            }
            (core.queue.take(), core.messages.take_undecided(), core.queue.is_waiting())
        };
        if let Some(reader) = &*lock(&self.reader) {
            if taken.had_blocked {
                reader.unblock();
            }
            if is_waiting {
                reader.signal();
            }
        }
        let (mut runs, mut received) = (Vec::new(), Vec::new());
        for item in &taken.items {
            match item {
                Item::Packets(run) => runs.push(to_run(py, run, &self.dialect)?),
                Item::Datagrams(one) => received.push(datagrams(py, one)?),
            }
        }
        let overloaded = taken.overloaded.into_iter().map(|number| (number, 0));
        Ok((runs, received, undecided, overloaded.chain(taken.ended).collect(), is_direct))
    }

    /// Call the listeners of packets, in order.
    ///
    /// Args:
    ///     packets: The packets.
    ///     find: Called with each packet whose listeners were not given to `decide`; returns their functions.
    ///     fail: Called with each exception of a listener.
    ///
    /// Raises:
    ///     BaseException: A listener raised an exception that is not an `Exception`.
    fn deliver(&self, packets: &Bound<'_, PyList>, find: &Bound<'_, PyAny>, fail: &Bound<'_, PyAny>) -> PyResult<()> {
        self.listeners.deliver(packets, find, fail)
    }

    /// Keep the latest packets of a system from now on.
    ///
    /// Args:
    ///     system: The system id.
    fn follow(&self, system: u8) {
        lock(&self.core).messages.follow(system);
    }

    /// End one `follow`.
    ///
    /// Args:
    ///     system: The system id.
    fn unfollow(&self, system: u8) {
        lock(&self.core).messages.unfollow(system);
    }

    /// Drop the latest packets of a system.
    ///
    /// Args:
    ///     system: The system id.
    fn clear(&self, system: u8) {
        lock(&self.core).messages.clear(system);
        self.made.clear(system);
    }

    /// Keep a packet as the latest of its message, if its system is followed.
    ///
    /// Args:
    ///     packet: The packet.
    ///     now: The time of its arrival in seconds.
    ///
    /// Raises:
    ///     TypeError: It is not a packet.
    fn keep(&self, packet: &Bound<'_, PyAny>, now: f64) -> PyResult<()> {
        packet::with_parts(packet, |header, raw| {
            let slot = self.dialect.get().core.entry(header.message_id).map(|entry| entry.slot);
            lock(&self.core).messages.keep(&Packet { raw, header, slot, timestamp: None }, now);
        })
    }

    /// Return the latest packet of a message, and the time of its arrival.
    ///
    /// Args:
    ///     source: System and component id.
    ///     message_id: The message id.
    ///
    /// Returns:
    ///     The packet, the same object until the next one arrives, and the time; None if there is none.
    fn latest<'py>(
        &self,
        py: Python<'py>,
        source: (u8, u8),
        message_id: u32,
    ) -> PyResult<Option<(Bound<'py, PyAny>, f64)>> {
        lock(&self.reader).iter().for_each(Reader::refresh);
        let key = (source.0, source.1, message_id);
        let core = lock(&self.core);
        let Some(latest) = core.messages.latest(source.0, source.1, message_id) else {
            return Ok(None);
        };
        if let Some(made) = self.made.find(py, key, latest.number) {
            return Ok(Some((made, latest.at)));
        }
        let one = Packet { raw: &latest.raw, header: latest.header, slot: latest.slot, timestamp: None };
        let (made, number, at) = (packet::create(py, &one, &self.dialect)?, latest.number, latest.at);
        drop(core);
        self.made.keep(key, number, &made);
        Ok(Some((made, at)))
    }

    /// Return the time of the latest packet of a message; None if there is none.
    ///
    /// Args:
    ///     source: System and component id.
    ///     message_id: The message id.
    fn received_at(&self, source: (u8, u8), message_id: u32) -> Option<f64> {
        lock(&self.reader).iter().for_each(Reader::refresh);
        lock(&self.core).messages.latest(source.0, source.1, message_id).map(|latest| latest.at)
    }

    /// Return the time of the latest packet of a system; None if there is none.
    ///
    /// Args:
    ///     system: The system id.
    fn newest_time(&self, system: u8) -> Option<f64> {
        lock(&self.core).messages.newest_time(system)
    }

    /// Return the number of messages of a system of which a packet is kept.
    ///
    /// Args:
    ///     system: The system id.
    fn stored(&self, system: u8) -> usize {
        lock(&self.core).messages.stored(system)
    }
}
