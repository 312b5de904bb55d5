//! Tests of the light tree with random emitters.

use super::bounds::{LightBounds, OrientationCone, Receiver, ReceivingPoint, ReceivingSegment};
use super::tree::{LEAF, LightTree};
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// A test emitter: points that shine within a cone around a normal.
struct TestEmitter {
    points: Vec<DVec3>,
    normal: DVec3,
    half_angle: f64,
    bounds: LightBounds,
}

impl TestEmitter {
    fn lights(&self, receiver: &ReceivingPoint) -> bool {
        self.points.iter().any(|point| {
            let direction = (receiver.position - point).normalize();
            direction.dot(self.normal) > self.half_angle.cos() && receiver.normal.dot(direction) <= 0.0
        })
    }
}

fn random_point(stream: &mut Stream) -> DVec3 {
    DVec3::from(stream.triple()) * 10.0
}

fn random_direction(stream: &mut Stream) -> DVec3 {
    warp::sphere(stream.pair())
}

/// Returns points, panels and spots. Some are in a row, some at the same place.
fn random_emitters(count: usize, stream: &mut Stream) -> Vec<TestEmitter> {
    let emitter = |i: usize| {
        let at = match i % 5 {
            0 => DVec3::new(i as f64 * 0.01, 2.0, 3.0),
            1 => DVec3::splat(4.0),
            _ => random_point(stream),
        };
        let (normal, across) = (random_direction(stream), random_direction(stream).any_orthonormal_vector());
        let intensity = stream.uniform().powi(8) + 1e-6;
        let (points, half_angle, theta_o, theta_e) = match i % 3 {
            0 => (vec![at], PI, PI, FRAC_PI_2),
            1 => ([-0.4, 0.0, 0.4].map(|x| at + x * across).to_vec(), FRAC_PI_2, 0.0, FRAC_PI_2),
            _ => (vec![at], 0.3, 0.3, 0.0),
        };
        let corners = points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &point| (low.min(point), high.max(point)));
        let cone = OrientationCone { axis: normal, theta_o, theta_e };
        TestEmitter { points, normal, half_angle, bounds: LightBounds::new(corners, intensity, cone) }
    };
    (0..count).map(emitter).collect()
}

fn tree_over(emitters: &[TestEmitter]) -> LightTree {
    let mut tree = LightTree::default();
    tree.add(&emitters.iter().map(|emitter| emitter.bounds).collect::<Vec<_>>());
    tree
}

fn stream() -> Stream {
    Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0)
}

fn receivers(count: usize, stream: &mut Stream) -> Vec<ReceivingPoint> {
    let receiver = |i: usize| {
        let normal = if i.is_multiple_of(3) { DVec3::ZERO } else { random_direction(stream) };
        ReceivingPoint { position: random_point(stream), normal }
    };
    (0..count).map(receiver).collect()
}

/// The probabilities of all emitters and of none sum to 1, and are the frequencies of samples.
#[test]
fn samples_have_their_probabilities() {
    let mut stream = stream();
    let emitters = random_emitters(200, &mut stream);
    let tree = tree_over(&emitters);
    for receiver in receivers(40, &mut stream) {
        let probabilities: Vec<f64> = (0..200).map(|emitter| tree.probability(0, emitter, &receiver)).collect();
        let (mut counts, mut none, n) = (vec![0; 200], 0, 20_000);
        for i in 0..n {
            let mut u = (f64::from(i) + 0.5) / f64::from(n);
            match tree.sample(0, &receiver, &mut u) {
                Some((emitter, probability)) => {
                    counts[emitter] += 1;
                    assert!((probability / probabilities[emitter] - 1.0).abs() < 1e-12);
                    assert!((0.0..1.0).contains(&u));
                }
                None => none += 1,
            }
        }
        let sum = probabilities.iter().sum::<f64>() + f64::from(none) / f64::from(n);
        assert!((sum - 1.0).abs() < 0.01, "{sum}");
        // Each emitter owns one interval of u, so its count is exact up to the two ends.
        for (count, probability) in counts.iter().zip(&probabilities) {
            assert!((f64::from(*count) - probability * f64::from(n)).abs() <= 1.001, "{count} {probability}");
        }
    }
}

/// If no bound excludes light, the probabilities alone sum to 1.
#[test]
fn probabilities_of_point_lights_sum_to_one() {
    let mut stream = stream();
    let at: Vec<DVec3> = (0..300).map(|_| random_point(&mut stream)).collect();
    let bounds: Vec<_> = at.iter().map(|&at| LightBounds::new((at, at), 1.0, OrientationCone::ALL)).collect();
    let mut tree = LightTree::default();
    tree.add(&bounds);
    for _ in 0..100 {
        let receiver = ReceivingPoint::in_medium(random_point(&mut stream));
        let sum: f64 = (0..300).map(|emitter| tree.probability(0, emitter, &receiver)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}

#[test]
fn bounds_are_conservative() {
    let mut stream = stream();
    let emitters = random_emitters(500, &mut stream);
    let tree = tree_over(&emitters);
    let mut excluded = 0;
    for receiver in receivers(300, &mut stream) {
        for (number, emitter) in emitters.iter().enumerate() {
            let probability = tree.probability(0, number, &receiver);
            assert!(probability > 0.0 || !emitter.lights(&receiver), "{number} {receiver:?}");
            excluded += usize::from(probability == 0.0);
        }
    }
    assert!(excluded > 50_000, "{excluded}");
}

#[test]
fn bounds_of_segments_are_conservative() {
    let mut stream = stream();
    let emitters = random_emitters(300, &mut stream);
    let tree = tree_over(&emitters);
    let mut excluded = 0;
    for _ in 0..100 {
        let (from, to) = (random_point(&mut stream), random_point(&mut stream));
        for (number, emitter) in emitters.iter().enumerate() {
            let probability = tree.probability(0, number, &ReceivingSegment { from, to });
            let lit = (0..=50).any(|i| emitter.lights(&ReceivingPoint::in_medium(from.lerp(to, f64::from(i) / 50.0))));
            assert!(probability > 0.0 || !lit, "{number}");
            excluded += usize::from(probability == 0.0);
        }
    }
    assert!(excluded > 1_000, "{excluded}");
}

#[test]
fn importance_of_a_segment_is_the_integral_of_the_irradiance() {
    let at = DVec3::new(1.0, 2.0, 0.0);
    let mut tree = LightTree::default();
    tree.add(&[LightBounds::new((at, at), 3.0, OrientationCone::ALL)]);
    let importance = ReceivingSegment { from: DVec3::ZERO, to: DVec3::X * 4.0 }.importance(&tree.nodes[0].cluster);
    let expected = 3.0 * (1.5_f64.atan() + 0.5_f64.atan()) / 2.0;
    assert!((importance / expected - 1.0).abs() < 1e-5, "{importance} {expected}");
}

/// Lights whose distances double lie in a very deep tree. All trails stay within 64 bits.
#[test]
fn deep_trees_have_valid_trails() {
    let at = |i: i32| DVec3::X * 2.0_f64.powi(i);
    let bounds: Vec<_> = (-300..300).map(|i| LightBounds::new((at(i), at(i)), 1.0, OrientationCone::ALL)).collect();
    let mut tree = LightTree::default();
    tree.add(&bounds);
    for (leaf, node) in tree.nodes.iter().enumerate().filter(|(_, node)| node.link & LEAF != 0) {
        let (mut index, mut trail) = (0, tree.trails[(node.link & !LEAF) as usize]);
        while tree.nodes[index].link & LEAF == 0 {
            index = if trail & 1 == 0 { index + 1 } else { tree.nodes[index].link as usize };
            trail >>= 1;
        }
        assert_eq!((index, trail), (leaf, 0));
    }
}

#[test]
fn trees_are_deterministic() {
    let trees = [0, 1].map(|_| tree_over(&random_emitters(100, &mut stream())));
    let text = trees.map(|tree| format!("{tree:?}"));
    assert_eq!(text[0], text[1]);
}
