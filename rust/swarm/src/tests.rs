use crate::vector::{Vector, dot, length, squared, sub};
use crate::{HalfSpace, Parameters, next_velocities, program};
use proptest::prelude::*;

const PARAMETERS: Parameters =
    Parameters { distance: 2.0, horizon: 4.0, speed: 5.0, neighbours: 10, separation_time: 0.5 };

fn fly(positions: &mut [Vector], goals: &[Vector], steps: usize) -> f64 {
    let mut velocities = vec![[0.0; 3]; positions.len()];
    let mut nearest = f64::INFINITY;
    for _ in 0..steps {
        let preferred: Vec<Vector> = positions.iter().zip(goals).map(|(&at, &goal)| sub(goal, at)).collect();
        velocities = next_velocities(positions, &velocities, &preferred, &PARAMETERS);
        for (position, velocity) in positions.iter_mut().zip(&velocities) {
            for axis in 0..3 {
                position[axis] += 0.1 * velocity[axis];
            }
        }
        for (index, &first) in positions.iter().enumerate() {
            for &second in &positions[..index] {
                nearest = nearest.min(length(sub(first, second)));
            }
        }
    }
    nearest
}

#[test]
fn two_vehicles_that_exchange_places_keep_their_distance() {
    let goals = [[10.0, 0.1, 0.0], [-10.0, 0.0, 0.0]];
    let mut positions = [goals[1], goals[0]];
    let nearest = fly(&mut positions, &goals, 150);
    assert!(nearest > 1.99, "{nearest}");
    assert!(positions.iter().zip(&goals).all(|(&at, &goal)| length(sub(at, goal)) < 0.1));
}

#[test]
fn a_vehicle_alone_takes_its_preferred_velocity_up_to_the_limit() {
    let chosen = next_velocities(&[[0.0; 3]], &[[0.0; 3]], &[[30.0, 40.0, 0.0]], &PARAMETERS);
    assert!(length(sub(chosen[0], [3.0, 4.0, 0.0])) < 1e-9);
}

#[test]
fn vehicles_at_one_place_separate() {
    let mut positions = [[0.0; 3]; 4];
    for (index, position) in positions.iter_mut().enumerate() {
        position[0] = index as f64 * 1e-3;
    }
    let goals = positions;
    fly(&mut positions, &goals, 20);
    assert!(length(sub(positions[0], positions[3])) > 1.0);
}

fn numbers(limit: f64) -> impl Strategy<Value = Vector> {
    [-limit..limit, -limit..limit, -limit..limit]
}

fn half_spaces() -> impl Strategy<Value = Vec<HalfSpace>> {
    prop::collection::vec((numbers(1.0), -1.0..4.0f64), 0..7).prop_map(|planes| {
        planes
            .into_iter()
            .filter(|(direction, _)| squared(*direction) > 0.01)
            .map(|(direction, room)| {
                let normal = direction.map(|part| part / length(direction));
                HalfSpace { point: normal.map(|part| -part * room), normal }
            })
            .collect()
    })
}

proptest! {
    #[test]
    fn no_other_velocity_is_allowed_and_nearer(spaces in half_spaces(), wanted in numbers(8.0), others in prop::collection::vec(numbers(5.0), 40)) {
        let chosen = program::nearest_velocity(&spaces, 5.0, wanted);
        prop_assert!(length(chosen) <= 5.0 + 1e-6);
        let worst = |velocity: Vector| spaces.iter().map(|space| space.violation(velocity)).fold(0.0, f64::max);
        for other in others.into_iter().filter(|&other| length(other) <= 5.0) {
            if worst(chosen) > 1e-6 {
                prop_assert!(worst(other) > worst(chosen) - 1e-4);
            } else if worst(other) <= 0.0 {
                prop_assert!(length(sub(other, wanted)) > length(sub(chosen, wanted)) - 1e-4);
            }
        }
    }

    #[test]
    fn the_nearest_are_those_of_a_full_search(places in prop::collection::vec(numbers(9.0), 1..120), count in 1usize..40) {
        let search = crate::neighbours::Search::new(&places);
        let mut found = Vec::new();
        for own in 0..places.len() {
            search.nearest((places[own], own), count, &mut found);
            let mut all: Vec<f64> = (0..places.len()).filter(|&other| other != own)
                .map(|other| squared(sub(places[other], places[own]))).collect();
            all.sort_by(f64::total_cmp);
            all.truncate(count);
            prop_assert_eq!(found.iter().map(|&(distance, _)| distance).collect::<Vec<_>>(), all);
        }
    }

    #[test]
    fn numbers_stay_finite(places in prop::collection::vec((numbers(1e3), numbers(50.0), numbers(50.0)), 2..12)) {
        let positions: Vec<Vector> = places.iter().map(|each| each.0).collect();
        let velocities: Vec<Vector> = places.iter().map(|each| each.1).collect();
        let preferred: Vec<Vector> = places.iter().map(|each| each.2).collect();
        for velocity in next_velocities(&positions, &velocities, &preferred, &PARAMETERS) {
            prop_assert!(dot(velocity, velocity).is_finite() && length(velocity) <= 5.0 + 1e-6);
        }
    }
}
