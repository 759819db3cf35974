//! A free list of packet memory: a busy stream allocates and frees millions of packets.

use pyo3::ffi;
use std::cell::UnsafeCell;

/// Memory of freed packets.
struct FreeList(UnsafeCell<Vec<*mut ffi::PyObject>>);

// SAFETY: used with the interpreter lock held only, and never across a call that could release it.
unsafe impl Sync for FreeList {}

static FREE_LIST: FreeList = FreeList(UnsafeCell::new(Vec::new()));
/// Number of packet bytes in pooled memory: enough for most packets. Longer packets are not pooled.
const POOLED_BYTES: usize = 64;
const MAX_FREE: usize = 4096;

/// Allocates an object of `header_size` and `length` bytes and initialises only its object header; null with an error set
/// if there is no memory.
///
/// # Safety
/// The interpreter lock must be held, and `class` and `header_size` must be the same in every call.
#[inline]
pub unsafe fn allocate(class: *mut ffi::PyTypeObject, header_size: usize, length: usize) -> *mut ffi::PyObject {
    let capacity = length.max(POOLED_BYTES);
    // SAFETY: pooled memory holds a packet of `POOLED_BYTES`; new memory has the requested size.
    unsafe {
        let pooled = if capacity == POOLED_BYTES { (*FREE_LIST.0.get()).pop() } else { None };
        let memory = pooled.unwrap_or_else(|| ffi::PyObject_Malloc(header_size + capacity).cast());
        if memory.is_null() {
            return ffi::PyErr_NoMemory();
        }
        ffi::PyObject_InitVar(memory.cast(), class, length as isize).cast()
    }
}

/// Frees the memory of a packet, or pools it.
///
/// # Safety
/// The interpreter lock must be held, and `object` must be a deallocated packet.
#[inline]
pub unsafe fn release(object: *mut ffi::PyObject) {
    // SAFETY: guaranteed by the caller; a packet of up to `POOLED_BYTES` bytes was allocated with that capacity.
    unsafe {
        let freelist = &mut *FREE_LIST.0.get();
        if (*object.cast::<ffi::PyVarObject>()).ob_size as usize <= POOLED_BYTES && freelist.len() < MAX_FREE {
            freelist.push(object);
        } else {
            ffi::PyObject_Free(object.cast());
        }
    }
}
