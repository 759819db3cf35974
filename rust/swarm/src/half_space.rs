//! The velocities that one vehicle may take with respect to another one.

use crate::Parameters;
use crate::vector::{Vector, add, cross, dot, length, scale, squared, sub, unit};

/// All velocities `v` with `normal · (v - point) >= 0`.
#[derive(Clone, Copy, Debug)]
pub struct HalfSpace {
    /// A velocity on the border.
    pub point: Vector,
    /// The unit vector into the half space.
    pub normal: Vector,
}

impl HalfSpace {
    /// Return the half of the smallest change of the relative velocity that avoids a collision.
    #[must_use]
    pub fn reciprocal(apart: Vector, own: Vector, other: Vector, parameters: &Parameters) -> Self {
        let (change, normal) = smallest_change(apart, sub(own, other), parameters);
        Self { point: add(own, scale(normal, 0.5 * change)), normal }
    }

    /// Return how far a velocity is outside; negative inside.
    #[must_use]
    pub fn violation(&self, velocity: Vector) -> f64 {
        dot(self.normal, sub(self.point, velocity))
    }
}

/// Return the size and the direction of the smallest change of `relative` that leaves the set of collisions.
fn smallest_change(apart: Vector, relative: Vector, parameters: &Parameters) -> (f64, Vector) {
    let distance = parameters.distance;
    let squared_apart = squared(apart);
    if squared_apart <= distance * distance {
        return from_sphere(apart, relative, distance, parameters.separation_time);
    }
    // `tip` is the velocity as seen from the centre of the sphere that cuts off the cone.
    let tip = sub(relative, scale(apart, 1.0 / parameters.horizon));
    let along = dot(tip, apart);
    if along < 0.0 && along * along > distance * distance * squared(tip) {
        return from_sphere(apart, relative, distance, parameters.horizon);
    }
    let projected = dot(apart, relative);
    let outside = squared_apart - distance * distance;
    let rest = squared(relative) - squared(cross(apart, relative)) / outside;
    // The place on the axis whose sphere touches the cone in the direction of the velocity.
    let place = (projected + (projected * projected - squared_apart * rest).max(0.0).sqrt()) / squared_apart;
    let away = sub(relative, scale(apart, place));
    (distance * place - length(away), unit(away))
}

fn from_sphere(apart: Vector, relative: Vector, distance: f64, time: f64) -> (f64, Vector) {
    let tip = sub(relative, scale(apart, 1.0 / time));
    (distance / time - length(tip), unit(tip))
}
