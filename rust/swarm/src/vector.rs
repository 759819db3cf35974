//! Vectors of three numbers.

/// North, east, up, or any other three axes.
pub type Vector = [f64; 3];

pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn scale(a: Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn squared(a: Vector) -> f64 {
    dot(a, a)
}

pub fn length(a: Vector) -> f64 {
    squared(a).sqrt()
}

/// Return the unit vector of a direction; up if it has no length.
pub fn unit(a: Vector) -> Vector {
    let length = length(a);
    if length > 0.0 { scale(a, 1.0 / length) } else { [0.0, 0.0, 1.0] }
}

/// Return the vector, shortened to a length.
pub fn shortened(a: Vector, limit: f64) -> Vector {
    let length = length(a);
    if length > limit { scale(a, limit / length) } else { a }
}
