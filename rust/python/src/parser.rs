//! The push parser, as Python sees it.

use crate::buffers::Bytes;
use crate::dialect::{AnyDialect, Dialect};
use crate::packet;
use crate::signing::{self, Signing};
use crate::statistics::{Statistics, sources_to_dict};
use mavstack_core::parser as core;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Bytes of a packet on the mean, and of a chunk for whose packets room is made beforehand.
const TYPICAL_PACKET: usize = 32;
const MAX_RESERVED: usize = 1 << 20;

/// Finds the packets of one byte stream, however it is cut into chunks.
#[pyclass(module = "mavstack._core")]
pub struct Parser {
    core: core::Parser,
    #[pyo3(get)]
    dialect: Py<Dialect>,
    #[pyo3(get)]
    signing: Option<Py<Signing>>,
}

#[pymethods]
impl Parser {
    #[new]
    #[pyo3(signature = (dialect, *, signing = None, timestamped = false))]
    fn new(dialect: AnyDialect, signing: Option<Py<Signing>>, timestamped: bool) -> Self {
        Self { core: core::Parser::new(timestamped), dialect: dialect.0, signing }
    }

    /// The packets that `data` completes; `now` is the Unix time in seconds, needed for signing only.
    #[pyo3(signature = (data, now = None))]
    fn feed<'py>(&mut self, py: Python<'py>, data: Bytes<'_>, now: Option<f64>) -> PyResult<Bound<'py, PyList>> {
        let mut sink = Sink::new(py, &self.dialect, self.signing.as_ref(), now)?;
        sink.packets.reserve(data.len().min(MAX_RESERVED) / TYPICAL_PACKET);
        self.core.feed(&self.dialect.get().core, &data, |packet| sink.take(&packet));
        sink.finish()
    }

    /// Ends the stream: the packets that an unfinished one at its end may have hidden.
    #[pyo3(signature = (now = None))]
    fn flush<'py>(&mut self, py: Python<'py>, now: Option<f64>) -> PyResult<Bound<'py, PyList>> {
        let mut sink = Sink::new(py, &self.dialect, self.signing.as_ref(), now)?;
        self.core.flush(&self.dialect.get().core, |packet| sink.take(&packet));
        sink.finish()
    }

    /// What was counted so far.
    #[getter]
    fn statistics(&self) -> Statistics {
        self.core.statistics().into()
    }

    /// What was heard of each (system, component), and how much of it was lost.
    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sources_to_dict(py, self.core.sources())
    }

    /// Bytes that wait for more.
    #[getter]
    fn pending(&self) -> usize {
        self.core.pending()
    }
}

/// Turns the core's packets into Python's, leaving out those that signing refuses.
struct Sink<'py, 'a> {
    py: Python<'py>,
    dialect: &'a Py<Dialect>,
    signing: Option<PyRefMut<'py, Signing>>,
    now: Option<u64>,
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
        Ok(Self { py, dialect, signing, now, packets: Vec::new(), error: None })
    }

    #[inline]
    fn take(&mut self, packet: &core::Packet<'_>) {
        if let Some(signing) = &mut self.signing
            && signing.core.check(packet, self.now).is_err()
        {
            return;
        }
        match packet::create(self.py, packet, self.dialect) {
            Ok(packet) => self.packets.push(packet),
            Err(error) => self.error = Some(error),
        }
    }

    fn finish(self) -> PyResult<Bound<'py, PyList>> {
        let Self { py, signing, packets, error, .. } = self;
        // Making a list may run a finalizer, and that may use the same signing.
        drop(signing);
        match error {
            Some(error) => Err(error),
            None => PyList::new(py, packets),
        }
    }
}
