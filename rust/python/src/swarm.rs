//! Avoidance for many vehicles at once; positions and velocities are float64 arrays as bytes.

use crate::buffers::Bytes;
use mavstack_swarm::{Parameters, Vector, next_velocities};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

const NUMBER: usize = size_of::<f64>();

/// Return the next velocities of vehicles that avoid each other, three float64 for each vehicle.
///
/// Args:
///     positions: Metres along three axes for each vehicle.
///     velocities: Present velocities in m/s.
///     preferred: Velocities that the vehicles would choose alone.
///     distance: Metres that two vehicles keep.
///     horizon: Seconds within which no collision may happen.
///     speed: Largest speed in m/s.
///     neighbours: The number of nearest vehicles that are considered.
///     separation_time: Seconds within which vehicles that are too near separate.
#[pyfunction]
#[pyo3(signature = (positions, velocities, preferred, *, distance, horizon, speed, neighbours, separation_time))]
#[allow(clippy::too_many_arguments)] // keywords of one call from Python
pub fn avoiding_velocities<'py>(
    py: Python<'py>,
    positions: Bytes<'py>,
    velocities: Bytes<'py>,
    preferred: Bytes<'py>,
    distance: f64,
    horizon: f64,
    speed: f64,
    neighbours: usize,
    separation_time: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let parameters = Parameters { distance, horizon, speed, neighbours, separation_time };
    let (positions, velocities, preferred) = (vectors(&positions), vectors(&velocities), vectors(&preferred));
    if positions.len() != velocities.len() || positions.len() != preferred.len() {
        return Err(PyValueError::new_err("positions, velocities and preferred velocities must be equally many"));
    }
    let chosen = py.detach(|| next_velocities(&positions, &velocities, &preferred, &parameters));
    let bytes: Vec<u8> = chosen.into_iter().flatten().flat_map(f64::to_ne_bytes).collect();
    Ok(PyBytes::new(py, &bytes))
}

fn vectors(bytes: &[u8]) -> Vec<Vector> {
    let number = |at: &[u8]| f64::from_ne_bytes(at.try_into().expect("eight bytes"));
    bytes
        .chunks_exact(3 * NUMBER)
        .map(|each| [0, 1, 2].map(|axis| number(&each[axis * NUMBER..(axis + 1) * NUMBER])))
        .collect()
}
