//! The nearest vehicles of each vehicle, by a tree of boxes with a few vehicles each.

use crate::vector::{Vector, squared, sub};

/// A box with at most this number of vehicles is not divided: comparing all of them is faster.
const LEAF: usize = 10;

/// A vehicle's position and index.
type Place = (Vector, usize);

/// Vehicles in the order of a tree: each box is divided at the median along its longest axis.
pub struct Search {
    places: Vec<Place>,
    /// The axis and the place at which the box of each node is divided; node `n` has the halves `2n + 1` and `2n + 2`.
    borders: Vec<(usize, f64)>,
}

/// The vehicle whose neighbours are searched, and the best ones so far, the nearest first.
struct Query<'a> {
    own: usize,
    position: Vector,
    count: usize,
    found: &'a mut Vec<(f64, usize)>,
}

impl Search {
    pub fn new(positions: &[Vector]) -> Self {
        let mut places: Vec<Place> = positions.iter().copied().zip(0..).collect();
        let mut borders = Vec::new();
        divide(&mut places, 0, &mut borders);
        Self { places, borders }
    }

    /// Return the positions and indices of all vehicles, neighbours beside each other.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Put the squared distances and indices of the `count` nearest others into `found`, the nearest first.
    pub fn nearest(&self, (position, own): Place, count: usize, found: &mut Vec<(f64, usize)>) {
        found.clear();
        self.visit(&self.places, 0, &mut Query { own, position, count, found });
    }

    fn visit(&self, places: &[Place], node: usize, query: &mut Query) {
        if places.len() <= LEAF {
            for place in places {
                query.consider(place);
            }
            return;
        }
        let (axis, border) = self.borders[node];
        let (lower, upper) = places.split_at(places.len() / 2);
        let beyond = query.position[axis] - border;
        let halves = [(lower, 2 * node + 1), (upper, 2 * node + 2)];
        let (near, far) = if beyond < 0.0 { (halves[0], halves[1]) } else { (halves[1], halves[0]) };
        self.visit(near.0, near.1, query);
        if query.wants(beyond * beyond) {
            self.visit(far.0, far.1, query);
        }
    }
}

impl Query<'_> {
    /// Return whether a vehicle at a squared distance would be one of the nearest.
    fn wants(&self, distance: f64) -> bool {
        self.found.len() < self.count || self.found.last().is_some_and(|&(farthest, _)| distance < farthest)
    }

    fn consider(&mut self, &(position, index): &Place) {
        let distance = squared(sub(position, self.position));
        if index == self.own || !self.wants(distance) {
            return;
        }
        if self.found.len() < self.count {
            self.found.push((distance, index));
        }
        // The farthest one gives up its place; those that are farther than the new one move by one.
        let mut place = self.found.len() - 1;
        while place > 0 && self.found[place - 1].0 > distance {
            self.found[place] = self.found[place - 1];
            place -= 1;
        }
        self.found[place] = (distance, index);
    }
}

fn divide(places: &mut [Place], node: usize, borders: &mut Vec<(usize, f64)>) {
    if places.len() <= LEAF {
        return;
    }
    let extent = |axis: usize| {
        let numbers = places.iter().map(|(position, _)| position[axis]);
        let (low, high) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
    if borders.len() <= node {
        borders.resize(node + 1, (0, 0.0));
    }
    borders[node] = (axis, places[middle].0[axis]);
    let (lower, upper) = places.split_at_mut(middle);
    divide(lower, 2 * node + 1, borders);
    divide(upper, 2 * node + 2, borders);
}
