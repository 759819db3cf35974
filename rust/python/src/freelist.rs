//! Free lists of object memory: a busy stream allocates and frees millions of packets and messages.

use pyo3::ffi;
use std::cell::UnsafeCell;

/// Memory of freed objects of one size.
struct FreeList(UnsafeCell<Vec<*mut ffi::PyObject>>);

// SAFETY: used with the interpreter lock held only, and never across a call that could release it.
unsafe impl Sync for FreeList {}

impl FreeList {
    const fn new() -> Self {
        Self(UnsafeCell::new(Vec::new()))
    }

    /// # Safety
    /// The interpreter lock must be held.
    #[inline]
    unsafe fn pop(&self) -> Option<*mut ffi::PyObject> {
        // SAFETY: guaranteed by the caller; the reference ends here.
        unsafe { (*self.0.get()).pop() }
    }

    /// Keeps the memory of a freed object; returns false if the list is full.
    ///
    /// # Safety
    /// As [`Self::pop`].
    #[inline]
    unsafe fn push(&self, object: *mut ffi::PyObject) -> bool {
        // SAFETY: guaranteed by the caller; the reference ends here.
        let list = unsafe { &mut *self.0.get() };
        if list.len() >= MAX_FREE {
            return false;
        }
        list.push(object);
        true
    }
}

static PACKETS: FreeList = FreeList::new();
/// Number of packet bytes in pooled memory: enough for most packets. Longer packets are not pooled.
const POOLED_BYTES: usize = 64;
const MAX_FREE: usize = 4096;

/// Memory of messages, by step of their capacity. Longer messages are not pooled.
static MESSAGES: [FreeList; 5] = [const { FreeList::new() }; 5];
/// Python's allocator rounds up to as many bytes.
const STEP: usize = 16;
/// Bytes of the smallest capacity: with the headers of the object and of the collector they are a multiple of `STEP`.
const MIN_CAPACITY: usize = 8;

/// Allocates an object of `header_size` and `length` bytes and initialises only its object header; null with an error set
/// if there is no memory.
///
/// # Safety
/// The interpreter lock must be held, and `class` and `header_size` must be the same in every call.
#[inline]
pub unsafe fn allocate_packet(class: *mut ffi::PyTypeObject, header_size: usize, length: usize) -> *mut ffi::PyObject {
    let capacity = length.max(POOLED_BYTES);
    // SAFETY: pooled memory holds a packet of `POOLED_BYTES` without references, which still has its class; new memory
    // has the requested size.
    unsafe {
        if capacity == POOLED_BYTES
            && let Some(object) = PACKETS.pop()
        {
            ffi::Py_INCREF(object);
            (*object.cast::<ffi::PyVarObject>()).ob_size = length as isize;
            return object;
        }
        let memory = ffi::PyObject_Malloc(header_size + capacity);
        if memory.is_null() {
            return ffi::PyErr_NoMemory();
        }
        ffi::PyObject_InitVar(memory.cast(), class, length as isize).cast()
    }
}

/// Frees a packet, or pools its memory, which keeps the class and the reference to it.
///
/// # Safety
/// The interpreter lock must be held, and `object` must be a deallocated packet without references.
#[inline]
pub unsafe fn release_packet(object: *mut ffi::PyObject) {
    // SAFETY: guaranteed by the caller; a packet of up to `POOLED_BYTES` bytes was allocated with that capacity. Each
    // packet holds a reference of its class, which is released last.
    unsafe {
        let is_short = (*object.cast::<ffi::PyVarObject>()).ob_size as usize <= POOLED_BYTES;
        if !(is_short && PACKETS.push(object)) {
            let class = ffi::Py_TYPE(object);
            ffi::PyObject_Free(object.cast());
            ffi::Py_DECREF(class.cast());
        }
    }
}

/// Number of `STEP`s in the capacity of a message.
#[inline]
fn steps(length: usize) -> usize {
    (length + STEP - 1 - MIN_CAPACITY) / STEP
}

/// Number of payload bytes for which the memory of a message of `length` bytes must have room.
#[inline]
pub fn message_capacity(length: usize) -> usize {
    steps(length) * STEP + MIN_CAPACITY
}

/// Allocates a message of `length` bytes with a header of the collector, untracked, and initialises only its object
/// header; null with an error set if there is no memory.
///
/// # Safety
/// The interpreter lock must be held, and `class` must be a class made by `new_message_class`.
#[inline]
pub unsafe fn allocate_message(class: *mut ffi::PyTypeObject, length: usize) -> *mut ffi::PyObject {
    // SAFETY: pooled memory has the capacity of its list, and the headers that all those classes share.
    unsafe {
        if let Some(memory) = MESSAGES.get(steps(length)).and_then(|list| list.pop()) {
            return ffi::PyObject_InitVar(memory.cast(), class, length as isize).cast();
        }
        let object = ffi::PyObject_GC_NewVar::<ffi::PyObject>(class, message_capacity(length) as isize);
        if !object.is_null() {
            (*object.cast::<ffi::PyVarObject>()).ob_size = length as isize;
        }
        object
    }
}

/// Frees the memory of a message, or pools it.
///
/// # Safety
/// The interpreter lock must be held, and `object` must be a deallocated, untracked message with the memory layout of a
/// class made by `new_message_class`, and room for its `message_capacity`.
#[inline]
pub unsafe fn release_message(object: *mut ffi::PyObject) {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let length = (*object.cast::<ffi::PyVarObject>()).ob_size as usize;
        // The header of the collector keeps the mark of a called `__del__`, which the next object would inherit.
        let is_reusable = ffi::PyObject_GC_IsFinalized(object) == 0;
        if !(is_reusable && MESSAGES.get(steps(length)).is_some_and(|list| list.push(object))) {
            ffi::PyObject_GC_Del(object.cast());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_capacity_of_a_message_holds_its_payload_and_is_that_of_all_lengths_of_its_list() {
        for length in 0..=255 {
            let capacity = message_capacity(length);
            assert!(length <= capacity && capacity < length + STEP);
            assert_eq!(message_capacity(capacity), capacity);
        }
    }
}
