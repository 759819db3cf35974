//! Memory for packets: what is given back is kept for those to come, since a busy stream makes and drops millions.

use pyo3::ffi;
use std::cell::UnsafeCell;

/// Memory of packets that are gone.
struct Spare(UnsafeCell<Vec<*mut ffi::PyObject>>);

// SAFETY: used with the interpreter lock held only, and never across a call that could release it.
unsafe impl Sync for Spare {}

static SPARE: Spare = Spare(UnsafeCell::new(Vec::new()));
/// Room for bytes in a packet whose memory is kept: enough for most, and for all of these the same.
const SPARE_ROOM: usize = 64;
const MAX_SPARE: usize = 4096;

/// Memory of a packet of `length` bytes behind `head` others, its object header made and nothing else; null with an
/// error raised.
///
/// # Safety
/// The interpreter lock must be held, and `class` and `head` be the same in every call.
#[inline]
pub unsafe fn allocate(class: *mut ffi::PyTypeObject, head: usize, length: usize) -> *mut ffi::PyObject {
    let room = length.max(SPARE_ROOM);
    // SAFETY: spare memory has a packet's size with `SPARE_ROOM`; new memory has the size asked for.
    unsafe {
        let spare = if room == SPARE_ROOM { (*SPARE.0.get()).pop() } else { None };
        let memory = spare.unwrap_or_else(|| ffi::PyObject_Malloc(head + room).cast());
        if memory.is_null() {
            return ffi::PyErr_NoMemory();
        }
        ffi::PyObject_InitVar(memory.cast(), class, length as isize).cast()
    }
}

/// Gives a packet's memory back.
///
/// # Safety
/// The interpreter lock must be held, and `object` be a packet that is gone but for its memory.
#[inline]
pub unsafe fn release(object: *mut ffi::PyObject) {
    // SAFETY: as the caller promises; a packet of up to `SPARE_ROOM` bytes was allocated with that room.
    unsafe {
        let spare = &mut *SPARE.0.get();
        if (*object.cast::<ffi::PyVarObject>()).ob_size as usize <= SPARE_ROOM && spare.len() < MAX_SPARE {
            spare.push(object);
        } else {
            ffi::PyObject_Free(object.cast());
        }
    }
}
