//! Python interface of the push parser.

use crate::buffers::Bytes;
use crate::dialect::{AnyDialect, Dialect};
use crate::packet;
use crate::records::{RecordPart, Records};
use crate::signing::{self, Signing};
use crate::statistics::{Statistics, sources_to_dict};
use mavstack_core::parser as core;
use mavstack_intake::channel::SharedParser;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Mean packet length in bytes, for reserving a chunk's list of packets.
const MEAN_PACKET_LENGTH: usize = 32;
/// Maximum chunk length in bytes for which that list is reserved.
const MAX_CHUNK_RESERVED: usize = 1 << 20;

/// Parser of one byte stream: takes bytes in chunks of any size and returns the packets in them.
///
/// MAVLink 1 and 2 may be mixed. Bytes that are no valid packet never raise: they are counted in `statistics` and
/// skipped. Packets whose message id is not in the dialect are returned too, with `message` None.
///
/// Args:
///     dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
///     signing: Signing state of the link; packets that it refuses are not returned. None disables verification.
///     timestamped: True for a tlog, which has 8 bytes of time before each packet.
#[pyclass(module = "mavstack._core")]
pub struct Parser {
    /// Shared with an intake that parses the same stream.
    pub core: SharedParser,
    /// The layout tables of the dialect.
    #[pyo3(get)]
    dialect: Py<Dialect>,
    /// Signing state of the link, or None.
    #[pyo3(get)]
    signing: Option<Py<Signing>>,
}

#[pymethods]
impl Parser {
    #[new]
    #[pyo3(signature = (dialect, *, signing = None, timestamped = false))]
    fn new(dialect: AnyDialect, signing: Option<Py<Signing>>, timestamped: bool) -> Self {
        Self { core: Arc::new(Mutex::new(core::Parser::new(timestamped))), dialect: dialect.0, signing }
    }

    /// Parse the next bytes of the stream.
    ///
    /// Args:
    ///     data: The received bytes, in chunks of any size.
    ///     now: Current Unix time in seconds, used for signing only. With None, the age of a stream's first packet is
    ///         measured from the signing clock alone, and the maximum lead of a packet from the system's clock.
    ///
    /// Returns:
    ///     The packets completed by `data`, in order.
    ///
    /// Raises:
    ///     SigningError: `now` is not a valid time for signing.
    #[pyo3(signature = (data, now = None))]
    fn feed<'py>(&mut self, py: Python<'py>, data: Bytes<'_>, now: Option<f64>) -> PyResult<Bound<'py, PyList>> {
        let mut sink = Sink::new(py, &self.dialect, self.signing.as_ref(), now)?;
        sink.packets.reserve(data.len().min(MAX_CHUNK_RESERVED) / MEAN_PACKET_LENGTH);
        self.lock().feed(&self.dialect.get().core, &data, |packet| sink.push(&packet));
        list_of(py, sink.finish()?)
    }

    /// Parse the next bytes of the stream, and return its packets as records of a tlog: 8 bytes of time, then the packet.
    ///
    /// Args:
    ///     data: The received bytes, in chunks of any size.
    ///     time: The time of the records, in microseconds since 1970.
    ///     apart: Message ids whose packets are returned as packets, as signed ones are, to be changed before they are
    ///         recorded.
    ///     now: Current Unix time in seconds, as in `feed`.
    ///
    /// Returns:
    ///     The parts in order, each the bytes of records and their number, or one packet.
    ///
    /// Raises:
    ///     SigningError: `now` is not a valid time for signing.
    #[pyo3(signature = (data, time, apart, now = None))]
    fn feed_records<'py>(
        &mut self,
        py: Python<'py>,
        data: Bytes<'_>,
        time: u64,
        apart: Vec<u32>,
        now: Option<f64>,
    ) -> PyResult<Vec<RecordPart<'py>>> {
        let mut sink = Sink::new(py, &self.dialect, self.signing.as_ref(), now)?;
        let mut records = Records::new(time, data.len() * 5 / 4);
        self.lock().feed(&self.dialect.get().core, &data, |packet| {
            if !sink.accepts(&packet) {
                return;
            }
            if packet.header.signed() || apart.contains(&packet.header.message_id) {
                records.end_run();
                sink.add(&packet);
            } else {
                records.push(packet.raw);
            }
        });
        records.end_run();
        Ok(records.with_packets(py, sink.finish()?))
    }

    /// End the stream, and parse the rest of it.
    ///
    /// Args:
    ///     now: Current Unix time in seconds, as in `feed`.
    ///
    /// Returns:
    ///     The packets inside an apparent incomplete packet at the end of the stream.
    ///
    /// Raises:
    ///     SigningError: `now` is not a valid time for signing.
    #[pyo3(signature = (now = None))]
    fn flush<'py>(&mut self, py: Python<'py>, now: Option<f64>) -> PyResult<Bound<'py, PyList>> {
        let mut sink = Sink::new(py, &self.dialect, self.signing.as_ref(), now)?;
        self.lock().flush(&self.dialect.get().core, |packet| sink.push(&packet));
        list_of(py, sink.finish()?)
    }

    /// Totals of the stream so far.
    #[getter]
    fn statistics(&self) -> Statistics {
        self.lock().statistics().into()
    }

    /// Statistics of each source, by (system, component); of 1,024 sources, those with many packets are kept longest.
    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sources = self.lock().sources().clone();
        sources_to_dict(py, &sources)
    }

    /// Number of bytes kept until more arrive.
    #[getter]
    fn pending(&self) -> usize {
        self.lock().pending()
    }
}

/// Returns a list of objects, without the checks of each one that `PyList::new` does.
fn list_of<'py>(py: Python<'py>, objects: Vec<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyList>> {
    // SAFETY: the list is new and has a place for each object, whose reference it takes over.
    unsafe {
        let list = Bound::from_owned_ptr_or_err(py, ffi::PyList_New(objects.len() as ffi::Py_ssize_t))?;
        for (index, object) in objects.into_iter().enumerate() {
            ffi::PyList_SetItem(list.as_ptr(), index as ffi::Py_ssize_t, object.into_ptr());
        }
        Ok(list.cast_into_unchecked())
    }
}

impl Parser {
    fn lock(&self) -> MutexGuard<'_, core::Parser> {
        self.core.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Converts packets of the core to Python objects, without those that signing refuses.
struct Sink<'py, 'a> {
    py: Python<'py>,
    dialect: &'a Py<Dialect>,
    signing: Option<PyRefMut<'py, Signing>>,
    now: Option<u64>,
    latest: Option<u64>,
    packets: Vec<Bound<'py, PyAny>>,
    error: Option<PyErr>,
}

impl<'py, 'a> Sink<'py, 'a> {
    fn new(
        py: Python<'py>,
        dialect: &'a Py<Dialect>,
        signing: Option<&Py<Signing>>,
        now: Option<f64>,
    ) -> PyResult<Self> {
        let now = signing::timestamp(now)?;
        let signing = signing.map(|signing| signing.bind(py).try_borrow_mut()).transpose()?;
        let latest = signing.as_ref().and_then(|_| signing::latest(now));
        Ok(Self { py, dialect, signing, now, latest, packets: Vec::new(), error: None })
    }

    /// Returns whether signing accepts a packet.
    #[inline]
    fn accepts(&mut self, packet: &core::Packet<'_>) -> bool {
        match &mut self.signing {
            Some(signing) => signing.core.check_with_limit(packet, self.now, self.latest).is_ok(),
            None => true,
        }
    }

    #[allow(clippy::inline_always, reason = "copies of a packet's parts cost as much as the object")]
    #[inline(always)]
    fn push(&mut self, packet: &core::Packet<'_>) {
        if self.accepts(packet) {
            self.add(packet);
        }
    }

    #[allow(clippy::inline_always, reason = "copies of a packet's parts cost as much as the object")]
    #[inline(always)]
    fn add(&mut self, packet: &core::Packet<'_>) {
        match packet::create(self.py, packet, self.dialect) {
            Ok(packet) => self.packets.push(packet),
            Err(error) => self.error = Some(error),
        }
    }

    /// Returns the packets; the signing state is free afterwards, since other code may run then, which may use it.
    fn finish(self) -> PyResult<Vec<Bound<'py, PyAny>>> {
        match self.error {
            Some(error) => Err(error),
            None => Ok(self.packets),
        }
    }
}
