//! Message classes: a metaclass that stores a message's layout in its class object.
//!
//! Message classes are created by [`MessageMeta`](metaclass), a subclass of `type` whose objects (the classes) have one
//! [`Slot`] after the members of `type`. The slot holds the class's [`ClassData`] and the vectorcall function that makes
//! `Attitude(roll=0.1)` one call without a keyword dictionary. A class that a user derives from a message class has an
//! empty slot and is instantiated through `tp_new`.

use crate::buffers::Bytes;
use crate::construct;
use crate::dialect::{LayoutTuple, layout_from_tuple};
use crate::fields::FieldAccess;
use crate::keywords::Keywords;
use crate::message;
use mavstack_core::json::Member;
use mavstack_core::layout::{FieldType, Layout};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use std::ffi::{c_int, c_uint, c_ulong, c_void};
use std::ptr;

/// Py_TPFLAGS_HAVE_VECTORCALL: part of the stable ABI by number, though its name came later.
const HAVE_VECTORCALL: c_ulong = 1 << 11;

type VectorCall = unsafe extern "C" fn(
    *mut ffi::PyObject,
    *const *mut ffi::PyObject,
    usize,
    *mut ffi::PyObject,
) -> *mut ffi::PyObject;

/// The members that a message class adds to Python's class object.
#[repr(C)]
struct Slot {
    vectorcall: Option<VectorCall>,
    data: *mut ClassData,
    /// The name table of the data, so that reading a plain field needs no access to the data itself.
    names: *const [NameEntry],
}

/// The layout of a class, and the data of its field descriptors.
pub struct ClassData {
    pub layout: Layout,
    pub class_name: String,
    /// The class itself; only compared, never dereferenced.
    pub class: *mut ffi::PyTypeObject,
    /// True if instances have a header of the cycle collector. Instances of this class refer to no other objects and are
    /// not tracked; instances of a user's subclass may be.
    pub has_gc_header: bool,
    /// Payload of a message created without arguments.
    pub template: Vec<u8>,
    /// The members of the message as a JSON object, by field.
    pub members: Vec<Member>,
    /// Fields by the address of their interned names: an open-addressing hash table.
    by_name: Box<[NameEntry]>,
    /// The keyword names of the last calls, and the numbers among the fields, for fast construction.
    pub keywords: Keywords,
    /// The fields in definition order; boxed, because descriptors point into the slice.
    pub fields: Box<[FieldAccess]>,
}

/// An entry of the name table, with everything that reading a plain number needs.
#[derive(Clone, Copy)]
pub struct NameEntry {
    /// Null if the entry is free.
    name: *mut ffi::PyObject,
    pub field: u16,
    pub offset: u8,
    /// The type of a single number that is no enum; `None` for all other fields.
    pub plain: Option<FieldType>,
}

/// Looks up a field by its interned name; attribute names in Python code are interned.
#[inline]
pub fn find(table: &[NameEntry], name: *mut ffi::PyObject) -> Option<&NameEntry> {
    let mask = table.len() - 1;
    let mut position = hash(name);
    loop {
        let entry = &table[position & mask];
        if entry.name == name {
            return Some(entry);
        }
        if entry.name.is_null() {
            return None;
        }
        position += 1;
    }
}

/// Hashes an address: the upper half of the product depends on all its bits.
#[inline]
fn hash(name: *mut ffi::PyObject) -> usize {
    ((name as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize
}

fn name_table(fields: &[FieldAccess]) -> Box<[NameEntry]> {
    let free = NameEntry { name: ptr::null_mut(), field: 0, offset: 0, plain: None };
    let mut table = vec![free; (fields.len() * 2 + 1).next_power_of_two()].into_boxed_slice();
    let mask = table.len() - 1;
    for (number, access) in fields.iter().enumerate() {
        let mut position = hash(access.name.as_ptr()) & mask;
        while !table[position].name.is_null() {
            position = (position + 1) & mask;
        }
        let field = &access.field;
        let plain = field.array_length == 0 && !field.enumerated && field.kind != FieldType::Char;
        table[position] = NameEntry {
            name: access.name.as_ptr(),
            field: number as u16,
            offset: field.offset,
            plain: plain.then_some(field.kind),
        };
    }
    table
}

struct Meta {
    class: Py<PyType>,
    /// Offset of the slot in a class object: the size of a plain class object.
    slot_offset: usize,
}

static META: PyOnceLock<Meta> = PyOnceLock::new();

fn meta(py: Python<'_>) -> PyResult<&Meta> {
    META.get_or_try_init(py, || make_metaclass(py))
}

/// Returns the metaclass of message classes.
pub fn metaclass(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    Ok(meta(py)?.class.bind(py))
}

fn make_metaclass(py: Python<'_>) -> PyResult<Meta> {
    let slot_offset: usize = py.get_type::<PyType>().getattr("__basicsize__")?.extract()?;
    let members = Box::leak(Box::new([
        ffi::PyMemberDef {
            name: c"__vectorcalloffset__".as_ptr(),
            type_code: ffi::Py_T_PYSSIZET,
            offset: slot_offset as isize,
            flags: ffi::Py_READONLY,
            doc: ptr::null(),
        },
        // SAFETY: an all-zero member is the documented end of the table.
        unsafe { std::mem::zeroed() },
    ]));
    let mut slots = [
        slot(ffi::Py_tp_base, (&raw mut ffi::PyType_Type).cast()),
        slot(ffi::Py_tp_call, call_class as *mut c_void),
        slot(ffi::Py_tp_dealloc, dealloc_class as *mut c_void),
        slot(ffi::Py_tp_traverse, traverse_class as *mut c_void),
        slot(ffi::Py_tp_clear, clear_class as *mut c_void),
        slot(ffi::Py_tp_members, members.as_mut_ptr().cast()),
        slot(ffi::Py_tp_doc, c"Metaclass of the message classes.".as_ptr().cast_mut().cast()),
        slot(0, ptr::null_mut()),
    ];
    let mut spec = ffi::PyType_Spec {
        name: c"mavstack._core.MessageMeta".as_ptr(),
        basicsize: (slot_offset + size_of::<Slot>()) as c_int,
        itemsize: 0,
        flags: (ffi::Py_TPFLAGS_DEFAULT | ffi::Py_TPFLAGS_BASETYPE | ffi::Py_TPFLAGS_HAVE_GC | HAVE_VECTORCALL)
            as c_uint,
        slots: slots.as_mut_ptr(),
    };
    // SAFETY: the spec and its slots live through the call; the members table is leaked. The basic size is that of
    // `type` plus the slot, and the vectorcall offset is that of the slot's first member.
    let class = unsafe { Bound::from_owned_ptr_or_err(py, ffi::PyType_FromSpec(&raw mut spec)) }?;
    Ok(Meta { class: class.cast_into::<PyType>()?.unbind(), slot_offset })
}

pub fn slot(number: c_int, value: *mut c_void) -> ffi::PyType_Slot {
    ffi::PyType_Slot { slot: number, pfunc: value }
}

unsafe extern "C" fn call_class(
    class: *mut ffi::PyObject,
    args: *mut ffi::PyObject,
    kwargs: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: `type` has a tp_call of exactly this type, and the arguments are passed on unchanged.
    unsafe {
        let call: ffi::ternaryfunc =
            std::mem::transmute(ffi::PyType_GetSlot(&raw mut ffi::PyType_Type, ffi::Py_tp_call));
        call(class, args, kwargs)
    }
}

/// Visits the references of a class for the cycle collector: those of `type`, the enum members of its fields, and
/// the keyword names of the last calls.
unsafe extern "C" fn traverse_class(class: *mut ffi::PyObject, visit: ffi::visitproc, arg: *mut c_void) -> c_int {
    // SAFETY: the collector calls this with a class of the metaclass and holds the interpreter; no object is created,
    // changed or released here.
    unsafe {
        let traverse: ffi::traverseproc =
            std::mem::transmute(ffi::PyType_GetSlot(&raw mut ffi::PyType_Type, ffi::Py_tp_traverse));
        let answer = traverse(class, visit, arg);
        let Some(data) = META.get(Python::assume_attached()).and_then(|meta| (*slot_of(class, meta)).data.as_ref())
        else {
            return answer;
        };
        let references = data.fields.iter().flat_map(FieldAccess::references).chain(data.keywords.references());
        if answer == 0 {
            references.map(|object| visit(object, arg)).find(|&answer| answer != 0).unwrap_or(0)
        } else {
            answer
        }
    }
}

/// Breaks cycles through a class as `type` does; the references of its fields are released with the class.
unsafe extern "C" fn clear_class(class: *mut ffi::PyObject) -> c_int {
    // SAFETY: `type` has a tp_clear of exactly this type, and the argument is passed on unchanged.
    unsafe {
        let clear: ffi::inquiry = std::mem::transmute(ffi::PyType_GetSlot(&raw mut ffi::PyType_Type, ffi::Py_tp_clear));
        clear(class)
    }
}

/// Frees a class and then its data: instances and descriptors hold the class, so none can be left.
unsafe extern "C" fn dealloc_class(class: *mut ffi::PyObject) {
    // SAFETY: Python calls this once, with a class of the metaclass; the data pointer is null or from
    // `Box::into_raw`, and all users of the data hold the class.
    unsafe {
        let py = Python::assume_attached();
        let data = META.get(py).map(|meta| (*slot_of(class, meta)).data);
        let metatype = ffi::Py_TYPE(class);
        let dealloc: ffi::destructor =
            std::mem::transmute(ffi::PyType_GetSlot(&raw mut ffi::PyType_Type, ffi::Py_tp_dealloc));
        dealloc(class);
        ffi::Py_DECREF(metatype.cast());
        if let Some(data) = data.filter(|data| !data.is_null()) {
            // Attached, PyO3 releases references immediately; when the interpreter shuts down, the data is leaked.
            Python::try_attach(|_| drop(Box::from_raw(data)));
        }
    }
}

fn slot_of(class: *mut ffi::PyObject, meta: &Meta) -> *mut Slot {
    class.wrapping_byte_add(meta.slot_offset).cast()
}

/// Returns the data of a message class, or of the message class from which a class derives.
pub fn class_data(py: Python<'_>, class: *mut ffi::PyTypeObject) -> Option<&ClassData> {
    // SAFETY: the caller holds the class.
    if let Some(data) = unsafe { direct_data(py, class) } {
        return Some(data);
    }
    let meta = META.get(py)?;
    let mut class = class;
    while !class.is_null() {
        // SAFETY: `class` is a live class; only objects of the metaclass have the slot that is read, and a
        // class's data lives as long as the class, which its caller holds.
        unsafe {
            if ffi::PyObject_TypeCheck(class.cast(), meta.class.as_ptr().cast()) != 0 {
                let data = (*slot_of(class.cast(), meta)).data;
                if !data.is_null() {
                    return Some(&*data);
                }
            }
            class = ffi::PyType_GetSlot(class, ffi::Py_tp_base).cast();
        }
    }
    None
}

/// Create a message class whose fields read and write the payload bytes.
///
/// The class must have the class method `_enum_values(field_name)`, which returns `(members by value, fallback or None)`
/// and is called once per enum field, on first read; `fallback(int)` is called for values without a member.
///
/// Args:
///     name: The class name.
///     bases: The base classes; one of them derives from `MessageBase`.
///     namespace: The class attributes.
///     layout: The layout of the message.
///     template: The payload of a message created without arguments, padded with zeros; all zeros if None.
///     members: The name of each field in JSON, and whether its value is hidden there; None: the names of the layout,
///         nothing hidden.
///
/// Returns:
///     The new class.
///
/// Raises:
///     DialectError: The layout contradicts itself.
///     TypeError: A base has a dictionary or weak references, or none derives from `MessageBase`.
///     ValueError: There is not one member for each field.
#[pyfunction]
#[pyo3(signature = (name, bases, namespace, layout, template = None, members = None))]
pub fn new_message_class<'py>(
    py: Python<'py>,
    name: &str,
    bases: Bound<'py, PyTuple>,
    namespace: Bound<'py, PyDict>,
    layout: LayoutTuple,
    template: Option<Bytes<'py>>,
    members: Option<Vec<(String, bool)>>,
) -> PyResult<Bound<'py, PyType>> {
    let layout = layout_from_tuple(layout)?;
    let mut default = template.map_or_else(Vec::new, |template| template.to_vec());
    default.resize(layout.length.into(), 0);
    let members = json_members(&layout, members)?;
    let meta = meta(py)?;
    if !namespace.contains("__slots__")? {
        namespace.set_item("__slots__", PyTuple::empty(py))?;
    }
    let class = meta.class.bind(py).call1((name, bases, namespace))?.cast_into::<PyType>()?;
    if !class.is_subclass(message::base_class(py)?)? {
        return Err(PyTypeError::new_err("a message class must derive from MessageBase"));
    }
    for room in ["__dictoffset__", "__weakrefoffset__"] {
        if class.getattr(room)?.extract::<isize>()? != 0 {
            return Err(PyTypeError::new_err("a message class must not have a dictionary or weak references"));
        }
    }
    let fields: Box<[FieldAccess]> =
        layout.fields.iter().map(|field| FieldAccess::new(py, field, name, &class)).collect::<PyResult<_>>()?;
    // SAFETY: the class is a live class.
    let has_gc_header = unsafe { ffi::PyType_GetFlags(class.as_type_ptr()) } & ffi::Py_TPFLAGS_HAVE_GC != 0;
    let data = Box::into_raw(Box::new(ClassData {
        layout,
        class_name: name.into(),
        class: class.as_type_ptr(),
        has_gc_header,
        template: default,
        members,
        by_name: name_table(&fields),
        keywords: Keywords::new(&fields),
        fields,
    }));
    // SAFETY: the class was just made by the metaclass, so it has the slot; it owns the data from here on.
    unsafe {
        let names = &raw const *(*data).by_name;
        *slot_of(class.as_ptr(), meta) = Slot { vectorcall: Some(construct::vectorcall), data, names };
    }
    // SAFETY: the data is alive, the class is held, and no other reference to the data exists yet.
    for field in unsafe { &mut (*data).fields } {
        field.install(&class)?;
    }
    Ok(class)
}

fn json_members(layout: &Layout, members: Option<Vec<(String, bool)>>) -> PyResult<Vec<Member>> {
    let Some(members) = members else {
        return Ok(layout.fields.iter().map(|field| Member::new(&field.name, false)).collect());
    };
    if members.len() != layout.fields.len() {
        return Err(PyValueError::new_err("members must have one item for each field"));
    }
    Ok(members.iter().map(|(name, hidden)| Member::new(name, *hidden)).collect())
}

/// Returns the data of a class if it was made by `new_message_class`, not derived from such a class by a user.
///
/// # Safety
/// `class` must be a live class, held by the caller for as long as the result is used.
#[inline]
pub unsafe fn direct_data(py: Python<'_>, class: *mut ffi::PyTypeObject) -> Option<&ClassData> {
    let meta = META.get(py)?;
    // SAFETY: objects of the metaclass have the slot, whose data is null or lives as long as the class.
    unsafe {
        let is_ours = ptr::eq(ffi::Py_TYPE(class.cast()), meta.class.as_ptr().cast());
        if is_ours { (*slot_of(class.cast(), meta)).data.as_ref() } else { None }
    }
}

/// Returns the name table of a class made by `new_message_class`.
///
/// # Safety
/// As [`direct_data`].
#[inline]
pub unsafe fn direct_names(py: Python<'_>, class: *mut ffi::PyTypeObject) -> Option<&[NameEntry]> {
    let meta = META.get(py)?;
    // SAFETY: as in `direct_data`; the name table belongs to the data and lives as long.
    unsafe {
        let is_ours = ptr::eq(ffi::Py_TYPE(class.cast()), meta.class.as_ptr().cast());
        let slot = slot_of(class.cast(), meta);
        if is_ours && !(*slot).data.is_null() { (*slot).names.as_ref() } else { None }
    }
}

/// Returns the data of the class of a vectorcall.
///
/// # Safety
/// `class` must be an object of the metaclass whose slot is filled.
pub unsafe fn own_data(py: Python<'_>, class: *mut ffi::PyObject) -> Option<&ClassData> {
    // SAFETY: guaranteed by the caller: the slot exists and its data lives as long as the class.
    META.get(py).map(|meta| unsafe { &*(*slot_of(class, meta)).data })
}
