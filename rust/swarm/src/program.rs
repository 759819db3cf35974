//! The linear program: the best velocity in a ball and in half spaces, added one after another.
//!
//! If the best velocity so far violates the next half space, the new best one lies on its border plane, where the half
//! spaces before it are half planes; if it violates one of these, on a line, where they are intervals. If nothing is left,
//! the largest violation is made as small as possible instead ([`min_violation`]).

use crate::half_space::HalfSpace;
use crate::vector::{Vector, add, cross, dot, length, scale, shortened, squared, sub, unit};

/// Directions whose sine is smaller count as parallel.
const PARALLEL: f64 = 1e-6;

/// The best of several velocities.
#[derive(Clone, Copy)]
enum Goal {
    /// The one nearest to a velocity.
    Near(Vector),
    /// The one farthest along a unit vector.
    Along(Vector),
}

/// Return the velocity within `limit` that is nearest to `wanted` in all half spaces, or violates them least.
pub fn nearest_velocity(half_spaces: &[HalfSpace], limit: f64, wanted: Vector) -> Vector {
    match in_space(half_spaces, limit, Goal::Near(wanted)) {
        Ok(velocity) => velocity,
        Err((failed, velocity)) => min_violation(half_spaces, failed, limit, velocity),
    }
}

/// Return the best velocity, or the index of the half space that leaves none, and the best one before it.
fn in_space(half_spaces: &[HalfSpace], limit: f64, goal: Goal) -> Result<Vector, (usize, Vector)> {
    let mut best = match goal {
        Goal::Near(wanted) => shortened(wanted, limit),
        Goal::Along(direction) => scale(direction, limit),
    };
    for (index, half_space) in half_spaces.iter().enumerate() {
        if half_space.violation(best) > 0.0 {
            best = on_plane(half_spaces, index, limit, goal).ok_or((index, best))?;
        }
    }
    Ok(best)
}

/// Return the best velocity on the border of one half space, in those before it.
fn on_plane(half_spaces: &[HalfSpace], index: usize, limit: f64, goal: Goal) -> Option<Vector> {
    let HalfSpace { point, normal } = half_spaces[index];
    let height = dot(point, normal);
    let radius = (limit * limit - height * height).max(-1.0);
    if radius < 0.0 {
        return None;
    }
    let centre = scale(normal, height);
    let mut best = match goal {
        Goal::Near(wanted) => {
            let projected = add(wanted, scale(normal, dot(sub(point, wanted), normal)));
            add(centre, shortened(sub(projected, centre), radius.sqrt()))
        }
        Goal::Along(direction) => {
            let flat = sub(direction, scale(normal, dot(direction, normal)));
            if squared(flat) <= PARALLEL * PARALLEL { centre } else { add(centre, scale(unit(flat), radius.sqrt())) }
        }
    };
    for other in 0..index {
        if half_spaces[other].violation(best) > 0.0 {
            let (start, direction) = intersection(&half_spaces[index], &half_spaces[other])?;
            best = on_line(&half_spaces[..other], start, direction, limit, goal)?;
        }
    }
    Some(best)
}

/// Return the best velocity on a line within the half spaces.
fn on_line(half_spaces: &[HalfSpace], start: Vector, direction: Vector, limit: f64, goal: Goal) -> Option<Vector> {
    let along = dot(start, direction);
    let discriminant = along * along + limit * limit - squared(start);
    if discriminant < 0.0 {
        return None;
    }
    let (mut low, mut high) = (-along - discriminant.sqrt(), -along + discriminant.sqrt());
    for half_space in half_spaces {
        let (missing, slope) = (half_space.violation(start), dot(direction, half_space.normal));
        if slope.abs() <= PARALLEL {
            if missing > 0.0 {
                return None;
            }
        } else if slope > 0.0 {
            low = low.max(missing / slope);
        } else {
            high = high.min(missing / slope);
        }
    }
    if low > high {
        return None;
    }
    let place = match goal {
        Goal::Near(wanted) => dot(sub(wanted, start), direction).clamp(low, high),
        Goal::Along(best) if dot(best, direction) > 0.0 => high,
        Goal::Along(_) => low,
    };
    Some(add(start, scale(direction, place)))
}

/// Return a point and the direction of the line in which two borders meet; None if they are parallel.
fn intersection(first: &HalfSpace, second: &HalfSpace) -> Option<(Vector, Vector)> {
    let direction = cross(second.normal, first.normal);
    if length(direction) <= PARALLEL {
        return None;
    }
    let within = cross(direction, first.normal);
    let place = second.violation(first.point) / dot(within, second.normal);
    Some((add(first.point, scale(within, place)), unit(direction)))
}

/// Return the velocity whose largest violation is least; the half spaces before `begin` are satisfied by `velocity`.
fn min_violation(half_spaces: &[HalfSpace], begin: usize, limit: f64, mut velocity: Vector) -> Vector {
    let mut largest = 0.0;
    let mut borders = Vec::with_capacity(half_spaces.len());
    for (index, half_space) in half_spaces.iter().enumerate().skip(begin) {
        if half_space.violation(velocity) <= largest {
            continue;
        }
        borders.clear();
        borders.extend(half_spaces[..index].iter().filter_map(|before| equal_violation(half_space, before)));
        if let Ok(found) = in_space(&borders, limit, Goal::Along(half_space.normal)) {
            velocity = found;
        }
        largest = half_space.violation(velocity);
    }
    velocity
}

/// Return the velocities that violate `before` at most as much as `new`; None if that is always so.
fn equal_violation(new: &HalfSpace, before: &HalfSpace) -> Option<HalfSpace> {
    let point = match intersection(new, before) {
        Some((point, _)) => point,
        None if dot(new.normal, before.normal) > 0.0 => return None,
        None => scale(add(new.point, before.point), 0.5),
    };
    Some(HalfSpace { point, normal: unit(sub(before.normal, new.normal)) })
}
