//! The nearest vehicles of each vehicle.

use crate::vector::{Vector, squared, sub};

/// Vehicles in the order of their first coordinate, from which the search goes in both directions.
pub struct Search<'a> {
    positions: &'a [Vector],
    order: Vec<usize>,
    place: Vec<usize>,
}

impl<'a> Search<'a> {
    pub fn new(positions: &'a [Vector]) -> Self {
        let mut order: Vec<usize> = (0..positions.len()).collect();
        order.sort_by(|&a, &b| positions[a][0].total_cmp(&positions[b][0]));
        let mut place = vec![0; positions.len()];
        for (index, &vehicle) in order.iter().enumerate() {
            place[vehicle] = index;
        }
        Self { positions, order, place }
    }

    /// Put the squared distances and indices of the `count` nearest others into `found`, the nearest first.
    pub fn nearest(&self, own: usize, count: usize, found: &mut Vec<(f64, usize)>) {
        found.clear();
        let start = self.place[own];
        let (before, after) = (&self.order[..start], &self.order[start + 1..]);
        let mut lower = before.iter().rev().peekable();
        let mut upper = after.iter().peekable();
        loop {
            let gap = |other: Option<&&usize>| {
                other.map_or(f64::INFINITY, |&&other| (self.positions[other][0] - self.positions[own][0]).abs())
            };
            let (below, above) = (gap(lower.peek()), gap(upper.peek()));
            let (nearer, next) = if below <= above { (below, lower.next()) } else { (above, upper.next()) };
            let Some(&other) = next else { return };
            let full = found.len() == count;
            if full && found.last().is_none_or(|&(farthest, _)| nearer * nearer >= farthest) {
                return;
            }
            let distance = squared(sub(self.positions[other], self.positions[own]));
            let index = found.partition_point(|&(nearer, _)| nearer <= distance);
            found.insert(index, (distance, other));
            found.truncate(count);
        }
    }
}
