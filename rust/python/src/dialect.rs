//! The layout tables of a dialect, and its message classes, created on first use.

use crate::errors::DialectError;
use crate::message;
use mavstack_core::layout::{self, Field, FieldType, Layout};
use pyo3::PyTraverseError;
use pyo3::gc::PyVisit;
use pyo3::prelude::*;
use pyo3::types::PyType;
use std::sync::{Arc, OnceLock};

/// (name, type, array length or 0, offset, true if it reads as an enum)
type FieldTuple = (String, String, u8, u8, bool);
/// (id, name, CRC_EXTRA, length without extensions, length with them, fields in definition order)
pub type LayoutTuple = (u32, String, u8, u8, u8, Vec<FieldTuple>);

/// The layout tables of one dialect.
///
/// Args:
///     name: Name of the dialect.
///     messages: Layouts of all messages.
///     make_class: Called with a message id when the class of the message is first needed; returns the class.
///
/// Raises:
///     DialectError: A layout contradicts itself, or two messages have the same id.
#[pyclass(frozen, module = "mavstack._core")]
pub struct Dialect {
    /// Name of the dialect.
    #[pyo3(get)]
    name: String,
    pub core: Arc<layout::Dialect>,
    make_class: Py<PyAny>,
    classes: Vec<OnceLock<MessageClass>>,
}

/// The class of a message, with the data that creating an instance needs.
pub struct MessageClass {
    pub class: Py<PyType>,
    /// Payload length, if instances are allocated by `message::allocate_plain`.
    pub plain: Option<u8>,
}

/// Converts a tuple to a layout.
pub fn layout_from_tuple((id, name, crc_extra, base_length, length, fields): LayoutTuple) -> PyResult<Layout> {
    let fields = fields
        .into_iter()
        .map(|(field, kind, array_length, offset, enumerated)| {
            let kind = FieldType::from_name(&kind)
                .ok_or_else(|| DialectError::new_err(format!("{name}.{field}: unknown field type {kind}")))?;
            Ok(Field { name: field, kind, array_length, offset, enumerated })
        })
        .collect::<PyResult<_>>()?;
    let layout = Layout { id, name, crc_extra, base_length, length, fields };
    layout.validate().map_err(|error| DialectError::new_err(error.0))?;
    Ok(layout)
}

#[pymethods]
impl Dialect {
    #[new]
    fn new(name: String, messages: &Bound<'_, PyAny>, make_class: Py<PyAny>) -> PyResult<Self> {
        let layouts = messages.try_iter()?.map(|each| layout_from_tuple(each?.extract()?));
        let layouts = layouts.collect::<PyResult<Vec<_>>>()?;
        let classes = layouts.iter().map(|_| OnceLock::new()).collect();
        let core = layout::Dialect::new(layouts).map_err(|error| DialectError::new_err(error.0))?;
        Ok(Self { name, core: Arc::new(core), make_class, classes })
    }

    /// The dialect itself, so that a core dialect is accepted where a dialect is expected.
    #[getter]
    fn core_dialect(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __len__(&self) -> usize {
        self.core.layouts().len()
    }

    fn __contains__(&self, message_id: u32) -> bool {
        self.core.entry(message_id).is_some()
    }

    fn __repr__(&self) -> String {
        format!("<core dialect {}: {} messages>", self.name, self.core.layouts().len())
    }

    // `make_class` is a method of the Python dialect that owns this object: a reference cycle.
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.make_class)?;
        self.classes.iter().filter_map(OnceLock::get).try_for_each(|made| visit.call(&made.class))
    }
}

impl Dialect {
    /// Returns the class of the message in `slot`, created on first use.
    #[inline]
    pub fn class(&self, py: Python<'_>, slot: u16) -> PyResult<&MessageClass> {
        let once = &self.classes[usize::from(slot)];
        if let Some(made) = once.get() {
            return Ok(made);
        }
        let made = self.make(py, slot)?;
        Ok(once.get_or_init(|| made))
    }

    /// Returns the Python dialect that owns this object: `make_class` is a method of it.
    pub fn owner<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.make_class.bind(py).getattr("__self__")
    }

    #[cold]
    fn make(&self, py: Python<'_>, slot: u16) -> PyResult<MessageClass> {
        let id = self.core.layouts()[usize::from(slot)].id;
        let class = self.make_class.bind(py).call1((id,))?.cast_into::<PyType>()?;
        let plain = message::plain_length(&class);
        Ok(MessageClass { class: class.unbind(), plain })
    }
}

/// A dialect argument: a `mavstack.Dialect`, a dialect module, or a core dialect.
pub struct AnyDialect(pub Py<Dialect>);

impl<'a, 'py> FromPyObject<'a, 'py> for AnyDialect {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(dialect) = object.cast::<Dialect>() {
            return Ok(Self(dialect.to_owned().unbind()));
        }
        let core = object.getattr("core_dialect")?;
        Ok(Self(core.cast_into::<Dialect>()?.unbind()))
    }
}
