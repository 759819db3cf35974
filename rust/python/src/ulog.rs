//! Python interface of the ULog reader: the index of a file or of a part of it, and its tables.

use crate::memory::{Table, require_read_only, shared, writable};
use crate::steps::Steps;
use mavstack_logs::ulog;
use mavstack_logs::ulog::header::Header;
use mavstack_logs::ulog::index::Options;
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Name, type, number of elements (0 for a single value) and position in the row of a column.
type Column<'a> = (&'a str, &'static str, usize, usize);
/// Position, time in microseconds since boot and body of a message.
type Entry<'py> = (usize, u64, Bound<'py, PyBytes>);

/// Index of a PX4 ULog, built without the interpreter lock.
///
/// A row of a table holds the time in microseconds (int64), the instance (uint8), three unused bytes and the fields of
/// the record without padding; its size is a multiple of four bytes.
///
/// Args:
///     data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
///     size: Number of bytes to index; None for the whole file.
///     positions: True to store the positions of the records, which `decode` needs; False to count them only.
///     threads: Maximum number of threads.
///     step: Number of bytes that are indexed at a time; None for all.
///     done: Called with the beginning and the end of each part of the data that is indexed; its result is ignored.
///
/// Raises:
///     BufferError: The buffer is writable or not contiguous.
///     ValueError: The buffer is no ULog, or uses features that are not supported.
#[pyclass(frozen, module = "mavstack._core")]
pub struct UlogIndex {
    core: ulog::index::Index,
    data: Arc<PyBuffer<u8>>,
    options: Options,
}

#[pymethods]
impl UlogIndex {
    #[new]
    #[pyo3(signature = (data, *, size = None, positions = true, threads = 1, step = None, done = None))]
    fn new(
        py: Python<'_>,
        data: PyBuffer<u8>,
        size: Option<usize>,
        positions: bool,
        threads: usize,
        step: Option<usize>,
        done: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        require_read_only(&data)?;
        // SAFETY: the buffer is read-only for Python. Another process may still write to a mapped file; the core
        // then reads old or new bytes, and checks every index it derives from them.
        let bytes = unsafe { shared(&data) }?;
        let header = Header::parse(bytes).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let options = Options { threads, positions, ..Options::default() };
        let end = size.unwrap_or(bytes.len());
        let mut steps = Steps::new(step, done);
        let index =
            || ulog::index::Index::first_in_steps(bytes, &header, end, options, steps.size(), |part| steps.done(part));
        let core = py.detach(index);
        steps.finish()?;
        Ok(Self { core, data: Arc::new(data), options })
    }

    /// Return the index as bytes, which `restore` takes.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let positions = self.options.positions;
        let saved = py.detach(|| if positions { self.core.save() } else { self.core.without_positions().save() });
        PyBytes::new(py, &saved)
    }

    /// Return the index of a whole file that was saved, without reading the file again.
    ///
    /// Args:
    ///     saved: The bytes that `save` returned.
    ///     data: A read-only buffer with the indexed bytes.
    ///     threads: Maximum number of threads.
    ///
    /// Returns:
    ///     The index, or None if the bytes cannot be those of an index of this file.
    ///
    /// Raises:
    ///     BufferError: The buffer is writable or not contiguous.
    ///     ValueError: The buffer is no ULog, or uses features that are not supported.
    #[staticmethod]
    #[pyo3(signature = (saved, data, *, threads = 1))]
    fn restore(py: Python<'_>, saved: &[u8], data: PyBuffer<u8>, threads: usize) -> PyResult<Option<Self>> {
        require_read_only(&data)?;
        // SAFETY: as in `new`.
        let bytes = unsafe { shared(&data) }?;
        let header = Header::parse(bytes).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let restored = py.detach(|| ulog::index::Index::restore(saved, bytes, &header));
        Ok(restored.map(|core| {
            let options = Options { threads, positions: !core.parts.is_empty(), ..Options::default() };
            Self { core, data: Arc::new(data), options }
        }))
    }

    /// Return the same index without the positions of the records, in less memory.
    fn without_positions(&self) -> Self {
        let options = Options { positions: false, ..self.options };
        Self { core: self.core.without_positions(), data: Arc::clone(&self.data), options }
    }

    /// Return the index of the next part of the file.
    ///
    /// Args:
    ///     size: Number of bytes to index.
    ///
    /// Returns:
    ///     The index, with the positions of its records, or None at the end of the file.
    fn following(&self, py: Python<'_>, size: usize) -> PyResult<Option<Self>> {
        // SAFETY: as in `new`.
        let bytes = unsafe { shared(&self.data) }?;
        let options = Options { positions: true, ..self.options };
        let core = py.detach(|| self.core.following(bytes, size, options));
        Ok(core.map(|core| Self { core, data: Arc::clone(&self.data), options }))
    }

    /// Version of the file format.
    #[getter]
    fn version(&self) -> u8 {
        self.core.header.version
    }

    /// Time since boot in microseconds at which logging started.
    #[getter]
    fn start_time(&self) -> u64 {
        self.core.header.start_time
    }

    /// Positions at which appended data begins.
    #[getter]
    fn appended(&self) -> Vec<usize> {
        self.core.header.appended.clone()
    }

    /// Position of the first byte after the indexed part.
    #[getter]
    fn end(&self) -> usize {
        self.core.end()
    }

    /// Whether the positions of the records are stored.
    #[getter]
    fn has_positions(&self) -> bool {
        self.options.positions
    }

    /// Number of records of each instance, by topic.
    #[getter]
    fn instances(&self) -> Vec<(&str, BTreeMap<usize, u64>)> {
        let counts = |table| self.core.instances(table).iter().copied().enumerate().filter(|&(_, count)| count > 0);
        let tables = self.core.tables().iter().enumerate();
        let all = tables.map(|(number, table)| (table.name.as_str(), counts(number).collect::<BTreeMap<_, _>>()));
        all.filter(|(_, counts)| !counts.is_empty()).collect()
    }

    /// Earliest and latest time of a record in microseconds since boot, or None without records.
    #[getter]
    fn time_span(&self) -> Option<(u64, u64)> {
        self.core.time_span
    }

    /// Position of the first subscription or logged text, where the definitions end; None if there is none.
    #[getter]
    fn definitions_end(&self) -> Option<usize> {
        self.core.definitions_end
    }

    /// Numbers of bytes and messages that were not read, by reason.
    #[getter]
    fn damage(&self) -> Vec<(&'static str, u64)> {
        let damage = &self.core.damage;
        vec![
            ("bad_bytes", damage.bad_bytes),
            ("gaps", damage.gaps),
            ("truncated_bytes", damage.truncated_bytes),
            ("wrong_size", damage.wrong_size),
            ("bad_definitions", damage.bad_definitions),
            ("bad_offsets", self.core.header.bad_offsets),
        ]
    }

    /// Number of records of each id without a usable subscription.
    #[getter]
    fn unsubscribed(&self) -> BTreeMap<u16, u64> {
        self.core.damage.unsubscribed.clone()
    }

    /// Number of messages of each unknown kind.
    #[getter]
    fn unknown_kinds(&self) -> BTreeMap<char, u64> {
        self.core.damage.unknown_kinds.iter().map(|(&kind, &count)| (char::from(kind), count)).collect()
    }

    /// Return the columns of a topic's table.
    ///
    /// Args:
    ///     topic: Name of the topic.
    ///
    /// Returns:
    ///     The size of a row in bytes, and for each column its name, its type as in ULog, the number of elements (0 for
    ///     a single value) and its position in the row.
    ///
    /// Raises:
    ///     KeyError: The file has no such topic.
    fn layout(&self, topic: &str) -> PyResult<(usize, Vec<Column<'_>>)> {
        let layout = &self.core.tables()[self.table(topic)?].layout;
        let fields = layout.fields.iter();
        let columns = fields.map(|field| (field.name.as_str(), field.kind.name(), field.count, field.offset));
        Ok((layout.row_size, columns.collect()))
    }

    /// Return the messages of one kind that are not records.
    ///
    /// Args:
    ///     kind: I, M, P, Q, L, C or O.
    ///     step: Number of bytes of the file that are read at a time; None for all.
    ///     done: Called with the beginning and the end of each part of the data that is read.
    ///
    /// Returns:
    ///     For each message its position, the latest time of a record before it in microseconds since boot, and its
    ///     body.
    #[pyo3(signature = (kind, *, step = None, done = None))]
    fn messages<'py>(
        &self,
        py: Python<'py>,
        kind: char,
        step: Option<usize>,
        done: Option<Py<PyAny>>,
    ) -> PyResult<Vec<Entry<'py>>> {
        // SAFETY: as in `new`.
        let bytes = unsafe { shared(&self.data) }?;
        let (mut messages, mut steps, mut begin) = (Vec::new(), Steps::new(step, done), 0);
        for entry in self.core.entries.iter().filter(|entry| char::from(entry.kind) == kind) {
            if entry.start.saturating_sub(begin) > steps.size() {
                steps.done(begin..entry.start);
                begin = entry.start;
            }
            messages.push((entry.start, entry.time, PyBytes::new(py, self.core.body(bytes, entry))));
        }
        steps.done(begin..bytes.len());
        steps.finish()?;
        Ok(messages)
    }

    /// Decode the rows of several topics in one pass.
    ///
    /// Args:
    ///     tables: For each topic its name and a writable buffer with the exact size of all its rows.
    ///     utc_offset: UTC minus time since boot in microseconds; None if it is unknown.
    ///     threads: Maximum number of threads.
    ///
    /// Raises:
    ///     KeyError: The file has no such topic.
    ///     ValueError: A buffer is read-only, has the wrong size or overlaps another, or the positions of the records
    ///         were not stored.
    #[pyo3(signature = (tables, *, utc_offset = None, threads = 1))]
    fn decode(
        &self,
        py: Python<'_>,
        tables: Vec<(String, PyBuffer<u8>)>,
        utc_offset: Option<i64>,
        threads: usize,
    ) -> PyResult<()> {
        if !self.options.positions {
            return Err(PyValueError::new_err("the index has no positions"));
        }
        let mut sized = Vec::with_capacity(tables.len());
        for (topic, buffer) in &tables {
            let slot = self.table(topic)?;
            let size = self.core.rows(slot) * self.core.tables()[slot].layout.row_size;
            sized.push(Table { slot, buffer, size });
        }
        // SAFETY: the Python part of the package creates the buffers for this call only.
        let rows = unsafe { writable(&sized) }?;
        // SAFETY: as in `new`.
        let bytes = unsafe { shared(&self.data) }?;
        py.detach(|| self.core.decode(bytes, rows, utc_offset, threads));
        Ok(())
    }
}

impl UlogIndex {
    fn table(&self, topic: &str) -> PyResult<usize> {
        self.core.table(topic).ok_or_else(|| PyKeyError::new_err(topic.to_owned()))
    }
}
