//! Python interface of the bulk decoder: the index of a file, and its tables.

use crate::dialect::{AnyDialect, Dialect};
use crate::memory::{Table, require_read_only, shared, writable};
use crate::statistics::{Statistics, sources_to_dict};
use mavstack_core::{bulk, scan, windows};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Number of bytes examined to detect timestamps.
const MAX_HEAD: usize = 1 << 18;

/// Return whether a file has a timestamp before each packet, as in a tlog.
///
/// Args:
///     head: The beginning of the file; at most 256 KiB are examined.
///     dialect: The dialect whose packets are searched for.
///
/// Returns:
///     True if most packets have 8 bytes before them, False if they follow each other directly.
#[pyfunction]
pub fn looks_timestamped(head: PyBuffer<u8>, dialect: AnyDialect) -> PyResult<bool> {
    // SAFETY: the interpreter lock is held throughout, so no Python code can write to the buffer.
    let bytes = unsafe { shared(&head) }?;
    Ok(scan::looks_timestamped(&bytes[..bytes.len().min(MAX_HEAD)], &dialect.0.get().core))
}

/// Index of all packets of a buffer by message, built without the interpreter lock.
///
/// A row of a table holds the time in microseconds (int64), system, component, sequence, version, and the full payload,
/// padded to a multiple of four bytes.
///
/// Args:
///     data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
///     dialect: The dialect of the messages.
///     timestamped: True if 8 bytes of time precede each packet, as in a tlog.
///     threads: Maximum number of threads.
///
/// Raises:
///     BufferError: The buffer is writable or not contiguous.
#[pyclass(frozen, module = "mavstack._core")]
pub struct Index {
    core: bulk::Index,
    dialect: Py<Dialect>,
    data: Arc<PyBuffer<u8>>,
}

#[pymethods]
impl Index {
    #[new]
    #[pyo3(signature = (data, dialect, *, timestamped, threads = 1))]
    fn new(
        py: Python<'_>,
        data: PyBuffer<u8>,
        dialect: AnyDialect,
        timestamped: bool,
        threads: usize,
    ) -> PyResult<Self> {
        require_read_only(&data)?;
        let dialect = dialect.0;
        // SAFETY: the buffer is read-only for Python. Another process may still write to a mapped file; the core
        // then reads old or new bytes, and checks every index it derives from them.
        let bytes = unsafe { shared(&data) }?;
        let layouts = &dialect.get().core;
        let core = py.detach(|| bulk::Index::build(bytes, layouts, timestamped, threads));
        Ok(Self { core, dialect, data: Arc::new(data) })
    }

    /// Return the index as bytes, which `restore` takes.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.core.save(&self.dialect.get().core)))
    }

    /// True if the index holds the positions of the packets, which `decode` needs.
    #[getter]
    fn has_positions(&self) -> bool {
        self.core.has_positions()
    }

    /// Return the same index without the positions of the packets, in less memory.
    fn without_positions(&self, py: Python<'_>) -> Self {
        let core = self.core.without_positions(&self.dialect.get().core);
        Self { core, dialect: self.dialect.clone_ref(py), data: Arc::clone(&self.data) }
    }

    /// Return an index that was saved, without reading the file again.
    ///
    /// Args:
    ///     saved: The bytes that `save` returned.
    ///     data: A read-only buffer with the indexed bytes.
    ///     dialect: The dialect of the messages.
    ///
    /// Returns:
    ///     The index, or None if the bytes are not those of an index of this dialect and size.
    ///
    /// Raises:
    ///     BufferError: The buffer is writable or not contiguous.
    #[staticmethod]
    fn restore(py: Python<'_>, saved: &[u8], data: PyBuffer<u8>, dialect: AnyDialect) -> PyResult<Option<Self>> {
        require_read_only(&data)?;
        let (dialect, size) = (dialect.0, data.len_bytes());
        let layouts = &dialect.get().core;
        let core = py.detach(|| bulk::Index::restore(saved, layouts, size));
        Ok(core.map(|core| Self { core, dialect, data: Arc::new(data) }))
    }

    /// Number of packets of each known message in the buffer, by message id.
    #[getter]
    fn counts(&self) -> BTreeMap<u32, usize> {
        counts_by_id(&self.dialect, |slot| self.core.rows(slot))
    }

    /// Number of packets of each message id that is not in the dialect.
    #[getter]
    fn unknown(&self) -> BTreeMap<u32, u64> {
        self.core.unknown().clone()
    }

    /// Totals of the buffer.
    #[getter]
    fn statistics(&self) -> Statistics {
        self.core.statistics().into()
    }

    /// Statistics of each source, by (system, component).
    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sources_to_dict(py, self.core.sources())
    }

    /// Earliest and latest timestamp in microseconds since 1970, or None without timestamps.
    #[getter]
    fn time_span(&self) -> Option<(u64, u64)> {
        self.core.time_span()
    }

    /// Return the size of one row of a message's table.
    ///
    /// Args:
    ///     message_id: Id of the message.
    ///
    /// Returns:
    ///     The size in bytes.
    ///
    /// Raises:
    ///     KeyError: The dialect has no message of that id.
    fn row_size(&self, message_id: u32) -> PyResult<usize> {
        Ok(bulk::row_size(&self.dialect.get().core.layouts()[self.slot(message_id)?]))
    }

    /// Decode the rows of several messages in one pass.
    ///
    /// Args:
    ///     tables: For each message its id and a writable buffer with the exact size of all its rows.
    ///     threads: Maximum number of threads.
    ///
    /// Raises:
    ///     KeyError: The dialect has no message of that id.
    ///     ValueError: A buffer is read-only, has the wrong size or overlaps another, or the index has no positions.
    #[pyo3(signature = (tables, *, threads = 1))]
    fn decode(&self, py: Python<'_>, tables: Vec<(u32, PyBuffer<u8>)>, threads: usize) -> PyResult<()> {
        if !self.core.has_positions() {
            return Err(PyValueError::new_err("the index has no positions"));
        }
        let mut sized = Vec::with_capacity(tables.len());
        for (message_id, buffer) in &tables {
            let slot = self.slot(*message_id)?;
            sized.push(Table { slot, buffer, size: self.core.rows(slot) * self.row_size(*message_id)? });
        }
        // SAFETY: the Python part of the package creates the buffers for this call only.
        let rows = unsafe { writable(&sized) }?;
        // SAFETY: as in `new`.
        let data = unsafe { shared(&self.data) }?;
        let layouts = &self.dialect.get().core;
        py.detach(|| self.core.decode(data, layouts, rows, threads));
        Ok(())
    }
}

/// The numbers of rows of the messages that have any, by message id.
fn counts_by_id(dialect: &Py<Dialect>, rows: impl Fn(usize) -> usize) -> BTreeMap<u32, usize> {
    let layouts = dialect.get().core.layouts().iter().enumerate();
    layouts.map(|(slot, layout)| (layout.id, rows(slot))).filter(|&(_, rows)| rows > 0).collect()
}

impl Index {
    fn slot(&self, message_id: u32) -> PyResult<usize> {
        let entry = self.dialect.get().core.entry(message_id);
        entry.map(|entry| usize::from(entry.slot)).ok_or_else(|| PyKeyError::new_err(message_id))
    }
}

/// Indexer of a file that is read piece by piece, in memory that does not grow with the file.
///
/// Args:
///     dialect: The dialect of the messages.
///     timestamped: True if 8 bytes of time precede each packet, as in a tlog.
///     threads: Maximum number of threads.
#[pyclass(module = "mavstack._core")]
pub struct WindowIndexer {
    core: windows::Indexer,
    dialect: Py<Dialect>,
    threads: usize,
}

#[pymethods]
impl WindowIndexer {
    #[new]
    #[pyo3(signature = (dialect, *, timestamped, threads = 1))]
    fn new(dialect: AnyDialect, timestamped: bool, threads: usize) -> Self {
        Self { core: windows::Indexer::new(timestamped), dialect: dialect.0, threads }
    }

    /// Index the complete packets of the next piece of the file.
    ///
    /// Args:
    ///     data: A read-only buffer: the bytes left over from the previous piece and those that follow them.
    ///     last: True if the file ends with this piece.
    ///
    /// Returns:
    ///     The index of the piece, and the number of bytes at its beginning that are done with.
    ///
    /// Raises:
    ///     BufferError: The buffer is writable or not contiguous.
    #[pyo3(signature = (data, *, last))]
    fn next(&mut self, py: Python<'_>, data: PyBuffer<u8>, last: bool) -> PyResult<(Index, usize)> {
        require_read_only(&data)?;
        // SAFETY: as in `Index::new`.
        let bytes = unsafe { shared(&data) }?;
        let (layouts, threads, indexer) = (&self.dialect.get().core, self.threads, &mut self.core);
        let (core, done) = py.detach(|| indexer.next(bytes, layouts, last, threads));
        Ok((Index { core, dialect: self.dialect.clone_ref(py), data: Arc::new(data) }, done))
    }

    /// Number of packets of each known message so far, by message id.
    #[getter]
    fn counts(&self) -> BTreeMap<u32, usize> {
        counts_by_id(&self.dialect, |slot| self.core.rows(slot))
    }

    /// Number of packets of each message id that is not in the dialect, so far.
    #[getter]
    fn unknown(&self) -> BTreeMap<u32, u64> {
        self.core.totals().unknown().clone()
    }

    /// Totals so far.
    #[getter]
    fn statistics(&self) -> Statistics {
        self.core.totals().statistics().into()
    }

    /// Statistics of each source so far, by (system, component).
    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        sources_to_dict(py, self.core.totals().sources())
    }

    /// Earliest and latest timestamp so far in microseconds since 1970, or None without timestamps.
    #[getter]
    fn time_span(&self) -> Option<(u64, u64)> {
        self.core.totals().time_span()
    }
}
