//! Memory that Python owns (a file's bytes, the rows of tables), for use without the interpreter lock.

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyBufferError, PyValueError};
use pyo3::prelude::*;

/// A table that is to be filled: its number, its buffer, and the size that the buffer must have.
pub struct Table<'a> {
    pub slot: usize,
    pub buffer: &'a PyBuffer<u8>,
    pub size: usize,
}

/// Returns the bytes of a buffer.
///
/// # Safety
/// The buffer must not be written to as long as the result is used.
pub unsafe fn shared(buffer: &PyBuffer<u8>) -> PyResult<&[u8]> {
    if !buffer.is_c_contiguous() {
        return Err(PyBufferError::new_err("the buffer must be contiguous"));
    }
    // SAFETY: the buffer is held for 'a and contiguous; the caller guarantees that it is not written to.
    Ok(unsafe { std::slice::from_raw_parts(buffer.buf_ptr().cast(), buffer.len_bytes()) })
}

/// Raises `BufferError` if Python could write to the buffer.
pub fn require_read_only(buffer: &PyBuffer<u8>) -> PyResult<()> {
    if buffer.readonly() {
        return Ok(());
    }
    Err(PyBufferError::new_err("the buffer must be read-only: bytes, or a map opened for reading"))
}

/// Returns the memory of tables, with their numbers.
///
/// Raises `ValueError` if a buffer is read-only, has the wrong size or overlaps another one.
///
/// # Safety
/// Nothing else may read or write the buffers as long as the result is used.
pub unsafe fn writable<'a>(tables: &[Table<'a>]) -> PyResult<Vec<(usize, &'a mut [u8])>> {
    for Table { buffer, size, .. } in tables {
        if buffer.readonly() || !buffer.is_c_contiguous() || buffer.len_bytes() != *size {
            return Err(PyValueError::new_err(format!("the buffer must be writable and have {size} bytes")));
        }
    }
    if overlap(tables) {
        return Err(PyValueError::new_err("the tables must not share memory"));
    }
    // SAFETY: the buffers are held for 'a, contiguous, writable and disjoint; the caller guarantees the rest.
    let memory =
        |table: &Table<'a>| unsafe { std::slice::from_raw_parts_mut(table.buffer.buf_ptr().cast::<u8>(), table.size) };
    Ok(tables.iter().map(|table| (table.slot, memory(table))).collect())
}

fn overlap(tables: &[Table<'_>]) -> bool {
    let mut spans: Vec<_> = tables.iter().map(|table| (table.buffer.buf_ptr().addr(), table.size)).collect();
    spans.sort_unstable();
    spans.windows(2).any(|pair| pair[0].0 + pair[0].1 > pair[1].0)
}
