//! Optimal reciprocal collision avoidance (van den Berg et al. 2011) in three dimensions.
//!
//! Every pair of vehicles has a set of relative velocities that lead to a collision within the horizon: a cone cut off by
//! a sphere ([`half_space`]). Each vehicle takes half of the smallest change that leaves the set, so its new velocity lies
//! in a half space. The velocity nearest to the preferred one in all half spaces and in the ball of the largest speed is
//! found by a linear program that adds one half space after another ([`program`]). A step costs O(n log n) for the
//! neighbours and O(k) expected for each vehicle with k of them.
#![forbid(unsafe_code)]

mod half_space;
mod neighbours;
mod program;
mod vector;

pub use half_space::HalfSpace;
pub use vector::Vector;

/// The parameters of a step; lengths in metres, times in seconds.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// The distance that two vehicles keep.
    pub distance: f64,
    /// The time within which no collision may happen.
    pub horizon: f64,
    /// The largest speed.
    pub speed: f64,
    /// The number of nearest vehicles that are considered.
    pub neighbours: usize,
    /// The time within which vehicles that are too near separate.
    pub separation_time: f64,
}

/// Return the next velocity of each vehicle.
///
/// Positions, velocities and preferred velocities have one length; missing ones end the result early.
#[must_use]
pub fn next_velocities(
    positions: &[Vector],
    velocities: &[Vector],
    preferred: &[Vector],
    parameters: &Parameters,
) -> Vec<Vector> {
    let search = neighbours::Search::new(positions);
    let mut nearest = Vec::with_capacity(parameters.neighbours + 1);
    let mut half_spaces = Vec::with_capacity(parameters.neighbours);
    let mut chosen = vec![[0.0; 3]; positions.len().min(velocities.len()).min(preferred.len())];
    // In the order of the search, so that the neighbours of one vehicle are still in the cache for the next one.
    for &(position, own) in search.places() {
        let (Some(next), Some(&velocity), Some(&wanted)) =
            (chosen.get_mut(own), velocities.get(own), preferred.get(own))
        else {
            continue;
        };
        search.nearest((position, own), parameters.neighbours, &mut nearest);
        half_spaces.clear();
        half_spaces.extend(nearest.iter().filter_map(|&(_, other)| {
            let apart = vector::sub(positions[other], position);
            let other_velocity = velocities.get(other)?;
            Some(HalfSpace::reciprocal(apart, velocity, *other_velocity, parameters))
        }));
        *next = program::nearest_velocity(&half_spaces, parameters.speed, wanted);
    }
    chosen
}

#[cfg(test)]
mod tests;
