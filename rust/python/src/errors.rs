//! The exceptions of `mavstack.errors` that the core raises.

use pyo3::import_exception;

import_exception!(mavstack.errors, DialectError);
import_exception!(mavstack.errors, EncodeError);
import_exception!(mavstack.errors, FieldNameError);
import_exception!(mavstack.errors, FieldRangeError);
import_exception!(mavstack.errors, FieldTypeError);
import_exception!(mavstack.errors, SigningError);
