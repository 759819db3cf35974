//! Python interface of the index of DataFlash logs.

use crate::memory::{Table, require_read_only, shared, writable};
use crate::steps::Steps;
use mavstack_logs::dataflash::row::{Conversion, Field, HeaderField, Layout, Time};
use mavstack_logs::dataflash::{Index, Request};
use mavstack_logs::rows::ROW_HEADER;
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Format character, conversion, position in the record, position in the row.
type FieldPlan = (char, char, usize, usize);
/// Format character and position in the record.
type HeaderPlan = (char, usize);

/// How the records of a definition become rows of a table.
///
/// A row begins with 12 bytes: the time in microseconds (int64), the instance (uint8) and zeros.
///
/// Args:
///     record_length: Length of a record in bytes, header included.
///     row_size: Size of a row in bytes.
///     fields: For each field its format character, its conversion ("=" copies, "0" copies and clears the bytes after
///         the NUL of a text, "*" divides an integer by 100 or, for "L", by 10^7, giving a float64), its position in
///         the record and its position in the row.
///     time: Format character and position in the record of the time, factor and offset: the time is the field times
///         the factor plus the offset, in microseconds. None leaves the time unknown (NaT).
///     instance: Format character and position in the record of the number of the instance, or None.
///
/// Raises:
///     ValueError: A field lies outside of the record or of the row, or has an unknown format character.
#[pyclass(frozen, module = "mavstack._core")]
pub struct DataFlashLayout(Layout);

#[pymethods]
impl DataFlashLayout {
    #[new]
    #[pyo3(signature = (record_length, row_size, fields, *, time = None, instance = None))]
    fn new(
        record_length: usize,
        row_size: usize,
        fields: Vec<FieldPlan>,
        time: Option<(char, usize, i64, i64)>,
        instance: Option<HeaderPlan>,
    ) -> PyResult<Self> {
        let fields: Option<Vec<_>> = fields.into_iter().map(field).collect();
        let time = time.map(|(character, source, factor, offset)| Time {
            field: HeaderField { character: ascii(character), source },
            factor,
            offset,
        });
        let instance = instance.map(|(character, source)| HeaderField { character: ascii(character), source });
        fields
            .and_then(|fields| Layout::new(record_length, row_size, &fields, time, instance))
            .map(Self)
            .ok_or_else(|| PyValueError::new_err("a field lies outside of the record or of the row, or is unknown"))
    }

    /// Size of a row in bytes.
    #[getter]
    fn row_size(&self) -> usize {
        self.0.row_size()
    }
}

fn ascii(character: char) -> u8 {
    u8::try_from(character).unwrap_or(0)
}

fn field((character, conversion, source, target): FieldPlan) -> Option<Field> {
    let conversion = match conversion {
        '=' => Conversion::Copy,
        '0' => Conversion::Text,
        '*' => Conversion::Scaled,
        _ => return None,
    };
    (target >= ROW_HEADER).then_some(Field { character: ascii(character), conversion, source, target })
}

/// Index of all records of a DataFlash log by definition, built without the interpreter lock.
///
/// Args:
///     data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
///     threads: Maximum number of threads.
///     step: Number of bytes that are indexed at a time; None for all.
///     done: Called with the beginning and the end of each part of the data that is indexed; its result is ignored.
///
/// Raises:
///     BufferError: The buffer is writable or not contiguous.
#[pyclass(frozen, module = "mavstack._core")]
pub struct DataFlashIndex {
    core: Index,
    data: Arc<PyBuffer<u8>>,
}

#[pymethods]
impl DataFlashIndex {
    #[new]
    #[pyo3(signature = (data, *, threads = 1, step = None, done = None))]
    fn new(
        py: Python<'_>,
        data: PyBuffer<u8>,
        threads: usize,
        step: Option<usize>,
        done: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        require_read_only(&data)?;
        // SAFETY: the buffer is read-only for Python. Another process may still write to a mapped file; the core
        // then reads old or new bytes, and checks every index it derives from them.
        let bytes = unsafe { shared(&data) }?;
        let mut steps = Steps::new(step, done);
        let core = py.detach(|| Index::build_in_steps(bytes, threads, steps.size(), |part| steps.done(part)));
        steps.finish()?;
        Ok(Self { core, data: Arc::new(data) })
    }

    /// Return the index as bytes, which `restore` takes.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.core.save()))
    }

    /// Return an index that was saved, without reading the log again.
    ///
    /// Args:
    ///     saved: The bytes that `save` returned.
    ///     data: A read-only buffer with the indexed bytes.
    ///
    /// Returns:
    ///     The index, or None if the bytes cannot be those of an index of this log.
    ///
    /// Raises:
    ///     BufferError: The buffer is writable or not contiguous.
    #[staticmethod]
    fn restore(py: Python<'_>, saved: &[u8], data: PyBuffer<u8>) -> PyResult<Option<Self>> {
        require_read_only(&data)?;
        // SAFETY: as in `new`.
        let bytes = unsafe { shared(&data) }?;
        let core = py.detach(|| Index::restore(saved, bytes));
        Ok(core.map(|core| Self { core, data: Arc::new(data) }))
    }

    /// True if the index holds the positions of records; without them, the log is read again when rows are needed.
    #[getter]
    fn has_positions(&self) -> bool {
        self.core.has_positions()
    }

    /// Return the same index in less memory, which is slower to decode with.
    fn without_positions(&self) -> Self {
        Self { core: self.core.without_positions(), data: Arc::clone(&self.data) }
    }

    /// The definitions as (name, format, labels, length of a record); their numbers are the slots of the tables.
    #[getter]
    #[allow(clippy::type_complexity)]
    fn definitions<'py>(
        &self,
        py: Python<'py>,
    ) -> Vec<(Bound<'py, PyBytes>, Bound<'py, PyBytes>, Bound<'py, PyBytes>, u8)> {
        let text = |text: &[u8]| PyBytes::new(py, text);
        let definitions = self.core.definitions().iter();
        definitions.map(|one| (text(&one.name), text(&one.format), text(&one.labels), one.length)).collect()
    }

    /// Where type numbers got a definition, in file order: (position in the file, type number, slot).
    #[getter]
    fn redefinitions(&self) -> Vec<(usize, u8, u16)> {
        self.core.redefinitions().iter().map(|one| (one.position, one.kind, one.slot)).collect()
    }

    /// Number of records by slot.
    #[getter]
    fn counts(&self) -> Vec<usize> {
        (0..self.core.definitions().len()).map(|slot| self.core.rows(slot)).collect()
    }

    /// Counts of what did not become a row or is doubtful, by name.
    #[getter]
    fn damage<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (damage, counts) = (self.core.damage(), PyDict::new(py));
        counts.set_item("bad_bytes", damage.bad_bytes)?;
        counts.set_item("damaged_records", damage.damaged_records)?;
        counts.set_item("suspect_records", damage.suspect_records)?;
        counts.set_item("bad_definitions", damage.bad_definitions)?;
        counts.set_item("truncated_bytes", damage.truncated_bytes)?;
        Ok(counts)
    }

    /// Number of headers of each type number that has no definition.
    #[getter]
    fn unknown(&self) -> BTreeMap<u8, u64> {
        self.core.damage().unknown.clone()
    }

    /// Return the number of records of each slot that begin before a position in the file.
    ///
    /// Args:
    ///     position: The position in bytes.
    fn rows_before(&self, py: Python<'_>, position: usize) -> PyResult<Vec<usize>> {
        // SAFETY: as in `new`.
        let data = unsafe { shared(&self.data) }?;
        Ok(py.detach(|| self.core.rows_before(data, position)))
    }

    /// Return the positions in the file of the records of a slot.
    ///
    /// Args:
    ///     slot: The slot.
    ///     first: Number of the first record.
    ///     count: Number of records.
    fn positions(&self, py: Python<'_>, slot: usize, first: usize, count: usize) -> PyResult<Vec<u64>> {
        let mut positions = vec![0; count.min(self.core.rows(slot).saturating_sub(first))];
        // SAFETY: as in `new`.
        let data = unsafe { shared(&self.data) }?;
        py.detach(|| self.core.positions(data, slot, first, &mut positions));
        Ok(positions)
    }

    /// Return a time for each record of a slot whose records have none: the time of the record before it.
    ///
    /// Records before all timed ones get the time of the first timed record; without any it is -2**63 (NaT).
    ///
    /// Args:
    ///     slot: The slot.
    ///     timed: The slots whose records have a time, each with a layout that has it.
    fn neighbour_times(
        &self,
        py: Python<'_>,
        slot: usize,
        timed: Vec<(usize, Py<DataFlashLayout>)>,
    ) -> PyResult<Vec<i64>> {
        let mut found = vec![0; self.core.rows(slot)];
        let clocks: Vec<_> = timed.iter().map(|(slot, layout)| (*slot, &layout.get().0)).collect();
        // SAFETY: as in `new`.
        let data = unsafe { shared(&self.data) }?;
        py.detach(|| self.core.neighbour_times(data, slot, &clocks, &mut found));
        Ok(found)
    }

    /// Decode rows of several tables in one pass.
    ///
    /// Args:
    ///     tables: For each table its slot, the number of the first row, the layout, and a writable buffer whose size is
    ///         a multiple of the size of a row.
    ///     threads: Maximum number of threads.
    ///
    /// Raises:
    ///     IndexError: The slot has fewer rows.
    ///     ValueError: A buffer is read-only, has no size of whole rows or overlaps another.
    #[pyo3(signature = (tables, *, threads = 1))]
    fn decode(
        &self,
        py: Python<'_>,
        tables: Vec<(usize, usize, Py<DataFlashLayout>, PyBuffer<u8>)>,
        threads: usize,
    ) -> PyResult<()> {
        let mut sized = Vec::with_capacity(tables.len());
        for (number, (slot, first, layout, buffer)) in tables.iter().enumerate() {
            let row_size = layout.get().0.row_size();
            let rows = buffer.len_bytes() / row_size;
            if rows > self.core.rows(*slot).saturating_sub(*first) {
                return Err(PyIndexError::new_err(format!("slot {slot} has fewer than {first} + {rows} rows")));
            }
            sized.push(Table { slot: number, buffer, size: rows * row_size });
        }
        // SAFETY: the Python part of the package creates the buffers for this call only.
        let memory = unsafe { writable(&sized) }?;
        let requests = memory.into_iter().map(|(number, rows)| {
            let (slot, first, layout, _) = &tables[number];
            Request { slot: *slot, first: *first, layout: &layout.get().0, rows }
        });
        let requests: Vec<_> = requests.collect();
        // SAFETY: as in `new`.
        let data = unsafe { shared(&self.data) }?;
        py.detach(|| self.core.decode(data, requests, threads));
        Ok(())
    }
}
