//! One received packet: its bytes as they came, and its message when asked for.

use crate::buffers::Bytes;
use crate::class;
use crate::dialect::{AnyDialect, Dialect};
use crate::message;
use mavstack_core::header::{CHECKSUM, Header, SIGNATURE};
use mavstack_core::parser::{self, Parser};
use mavstack_core::signing::link_and_timestamp;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple, PyType};
use std::sync::OnceLock;

/// A packet, byte for byte as it came.
#[pyclass(frozen, module = "mavstack._core")]
pub struct Packet {
    header: Header,
    slot: Option<u16>,
    timestamp: Option<u64>,
    dialect: Py<Dialect>,
    message: OnceLock<Py<PyAny>>,
    raw: Py<PyBytes>,
}

impl Packet {
    /// A new Python object for `packet`.
    #[inline]
    pub fn create(py: Python<'_>, packet: &parser::Packet<'_>, dialect: &Py<Dialect>) -> PyResult<Py<Self>> {
        let object = Py::new(py, Self::new(py, packet, dialect))?;
        // SAFETY: a new, fully made object that no one else has. A packet refers to its bytes, its dialect and its
        // message, none of which can refer back to it, so the cycle collector need not look at it.
        unsafe { pyo3::ffi::PyObject_GC_UnTrack(object.as_ptr().cast()) };
        Ok(object)
    }

    #[inline]
    fn new(py: Python<'_>, packet: &parser::Packet<'_>, dialect: &Py<Dialect>) -> Self {
        Self {
            header: packet.header,
            slot: packet.slot,
            timestamp: packet.timestamp,
            dialect: dialect.clone_ref(py),
            message: OnceLock::new(),
            raw: PyBytes::new(py, packet.raw).unbind(),
        }
    }

    fn bytes<'a>(&'a self, py: Python<'a>) -> &'a [u8] {
        self.raw.as_bytes(py)
    }

    fn make_message<'py>(&self, py: Python<'py>, slot: u16) -> PyResult<Bound<'py, PyAny>> {
        let class = self.dialect.get().class(py, slot)?;
        let Some(data) = class::class_data(py, class.as_type_ptr()) else {
            return Err(message::foreign_object());
        };
        // SAFETY: the data is that of the class.
        unsafe { message::allocate(py, class.as_type_ptr(), data, &self.bytes(py)[self.header.payload()]) }
    }
}

#[pymethods]
impl Packet {
    /// The one packet that `raw` holds, read by `dialect`; raises ValueError if it holds none or more.
    #[new]
    #[pyo3(signature = (raw, dialect, timestamp = None))]
    fn from_bytes(py: Python<'_>, raw: Bytes<'_>, dialect: AnyDialect, timestamp: Option<u64>) -> PyResult<Self> {
        let dialect = dialect.0;
        let (mut parser, mut found) = (Parser::new(false), None);
        parser.feed(&dialect.get().core, &raw, |packet| {
            found = Some(Self::new(py, &parser::Packet { timestamp, ..packet }, &dialect));
        });
        found
            .filter(|packet| packet.bytes(py).len() == raw.len())
            .ok_or_else(|| PyValueError::new_err("these bytes are not one whole MAVLink packet"))
    }

    /// The message, or `None` if the dialect does not have its id.
    #[getter]
    fn message(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        let Some(slot) = self.slot else {
            return Ok(None);
        };
        if let Some(message) = self.message.get() {
            return Ok(Some(message.clone_ref(py)));
        }
        let message = self.make_message(py, slot)?.unbind();
        Ok(Some(self.message.get_or_init(|| message).clone_ref(py)))
    }

    /// Official name of the message, or `None` if the dialect does not have its id.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.slot.map(|slot| self.dialect.get().core.layouts()[usize::from(slot)].name.as_str())
    }

    #[getter]
    fn version(&self) -> u8 {
        self.header.version
    }

    #[getter]
    fn message_id(&self) -> u32 {
        self.header.message_id
    }

    #[getter]
    fn system(&self) -> u8 {
        self.header.system
    }

    #[getter]
    fn component(&self) -> u8 {
        self.header.component
    }

    #[getter]
    fn sequence(&self) -> u8 {
        self.header.sequence
    }

    #[getter]
    fn incompat_flags(&self) -> u8 {
        self.header.incompat_flags
    }

    #[getter]
    fn compat_flags(&self) -> u8 {
        self.header.compat_flags
    }

    /// Whether the packet carries a signature; that it is a good one only a parser with signing says.
    #[getter]
    fn signed(&self) -> bool {
        self.header.signed()
    }

    /// Link id of the signature, or `None`.
    #[getter]
    fn link_id(&self, py: Python<'_>) -> Option<u8> {
        self.signed().then(|| link_and_timestamp(self.bytes(py)).0)
    }

    /// Timestamp of the signature in 10 µs since 2015, or `None`.
    #[getter]
    fn signature_timestamp(&self, py: Python<'_>) -> Option<u64> {
        self.signed().then(|| link_and_timestamp(self.bytes(py)).1)
    }

    /// Microseconds since 1970 recorded before the packet, or `None` outside a timestamped stream.
    #[getter]
    fn timestamp(&self) -> Option<u64> {
        self.timestamp
    }

    #[getter]
    fn checksum(&self, py: Python<'_>) -> u16 {
        let (raw, end) = (self.bytes(py), self.header.payload().end);
        u16::from_le_bytes([raw[end], raw[end + CHECKSUM - 1]])
    }

    /// The 13 bytes of the signature, or `None`.
    #[getter]
    fn signature<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.signed().then(|| PyBytes::new(py, &self.bytes(py)[self.header.packet_length() - SIGNATURE..]))
    }

    /// The payload as it came: trimmed, whole, or longer than known.
    #[getter]
    fn payload<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes(py)[self.header.payload()])
    }

    /// The whole packet as it came.
    #[getter]
    fn raw(&self, py: Python<'_>) -> Py<PyBytes> {
        self.raw.clone_ref(py)
    }

    fn __len__(&self) -> usize {
        self.header.packet_length()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let py = other.py();
        other.cast::<Self>().is_ok_and(|other| other.get().bytes(py) == self.bytes(py))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.raw.bind(py).hash()
    }

    fn __repr__(&self) -> String {
        let Header { message_id, version, system, component, sequence, .. } = self.header;
        let name = self.name().map_or_else(|| format!("unknown {message_id}"), ToOwned::to_owned);
        let signed = if self.signed() { " signed" } else { "" };
        format!("<Packet {name} v{version} from {system}/{component} #{sequence}{signed}>")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyType>, Bound<'py, PyTuple>)> {
        let (py, packet) = (slf.py(), slf.get());
        let arguments = (packet.raw(py), packet.dialect.get().owner(py)?, packet.timestamp);
        Ok((slf.get_type(), arguments.into_pyobject(py)?))
    }
}
