//! The shutter: when it is open, and how much light it lets through at each moment.

/// A shutter. One that closes at the moment it opens shows that moment, as sharp as the scene stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Shutter {
    /// It opens, in s.
    pub open_s: f64,
    /// It closes, in s.
    pub close_s: f64,
    /// Transmission over the time that it is open; fully open without.
    curve: Option<Curve>,
}

/// A transmission that is linear between points.
#[derive(Debug, Clone, PartialEq)]
struct Curve {
    /// Time as a share of the time open, and transmission; from 0 to 1.
    points: Vec<[f64; 2]>,
    /// The integral of the transmission up to each point.
    passed: Vec<f64>,
}

impl Curve {
    fn new(written: &[[f64; 2]]) -> Self {
        let mut points = written.to_vec();
        // Before the first point and after the last the transmission there is held.
        if let Some(&[_, held]) = written.first().filter(|point| point[0] > 0.0) {
            points.insert(0, [0.0, held]);
        }
        if let Some(&[_, held]) = written.last().filter(|point| point[0] < 1.0) {
            points.push([1.0, held]);
        }
        let mut passed = vec![0.0];
        for pair in points.windows(2) {
            let area = (pair[1][0] - pair[0][0]) * 0.5 * (pair[0][1] + pair[1][1]);
            passed.push(passed[passed.len() - 1] + area);
        }
        Self { points, passed }
    }

    /// The mean transmission.
    fn mean(&self) -> f64 {
        self.passed[self.passed.len() - 1]
    }

    /// The moment by which the share `u` of all light has passed.
    fn inverse(&self, u: f64) -> f64 {
        let wanted = u * self.mean();
        let last = self.passed.len() - 2;
        let piece = self.passed.partition_point(|&passed| passed <= wanted).saturating_sub(1).min(last);
        let [[from, a], [to, b]] = [self.points[piece], self.points[piece + 1]];
        let rest = wanted - self.passed[piece];
        // a·x + (b − a)·x²/2w = rest, in the form that keeps its digits where a is near b or near 0.
        let slope = (b - a) / (to - from);
        let root = (a * a + 2.0 * slope * rest).max(0.0).sqrt();
        let x = if a + root > 0.0 { 2.0 * rest / (a + root) } else { 0.0 };
        (from + x).min(to)
    }
}

impl Shutter {
    /// A shutter that is open from `open_s` to `close_s` (s, not before); `curve` is its transmission (0 to 1, not 0 throughout) over rising shares of
    /// that time.
    pub fn new(open_s: f64, close_s: f64, curve: Option<&[[f64; 2]]>) -> Self {
        Self { open_s, close_s, curve: curve.map(Curve::new) }
    }

    /// For how long it is open, in s: a time of half transmission counts half.
    pub fn exposure_s(&self) -> f64 {
        (self.close_s - self.open_s) * self.curve.as_ref().map_or(1.0, Curve::mean)
    }

    /// The moment (s) by which the share `u` in [0, 1] of all light has come through: uniform `u` give moments as dense as the shutter is open.
    pub fn time_s(&self, u: f64) -> f64 {
        let share = self.curve.as_ref().map_or(u, |curve| curve.inverse(u));
        (1.0 - share) * self.open_s + share * self.close_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_as_dense_as_the_shutter_is_open() {
        let curves: [&[[f64; 2]]; 5] = [
            &[[0.0, 1.0], [1.0, 1.0]],
            &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]],
            &[[0.0, 0.0], [0.1, 1.0], [0.9, 1.0], [1.0, 0.0]],
            &[[0.25, 0.5], [0.75, 1.0]],
            &[[0.0, 1.0], [0.4, 0.0], [0.6, 0.0], [1.0, 0.2]],
        ];
        for curve in curves {
            let shutter = Shutter::new(2.0, 4.0, Some(curve));
            let n = 1_000_000;
            let mean = (0..n).map(|i| shutter.time_s((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n);
            // The mean moment by Simpson's rule over the transmission: exact for pieces of a quadratic.
            let held = Curve::new(curve).points;
            let moment: f64 = held
                .windows(2)
                .map(|p| {
                    let at = |s: f64| (p[0][0] + s * (p[1][0] - p[0][0])) * (p[0][1] + s * (p[1][1] - p[0][1]));
                    (p[1][0] - p[0][0]) * (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0
                })
                .sum();
            let expected = 2.0 + 2.0 * moment / (shutter.exposure_s() / 2.0);
            assert!((mean - expected).abs() < 1e-6, "{curve:?}: {mean}, {expected}");
            assert!((0..=n).all(|i| (2.0..=4.0).contains(&shutter.time_s(f64::from(i) / f64::from(n)))));
        }
    }

    #[test]
    fn a_shutter_without_a_curve_is_a_box_and_may_have_no_length() {
        let shutter = Shutter::new(1.0, 3.0, None);
        assert_eq!([0.0, 0.25, 1.0].map(|u| shutter.time_s(u)), [1.0, 1.5, 3.0]);
        let instant = Shutter::new(0.7, 0.7, Some(&[[0.0, 0.0], [1.0, 1.0]]));
        assert_eq!([0.0, 0.3, 1.0].map(|u| instant.time_s(u)), [0.7; 3]);
        assert_eq!(instant.exposure_s(), 0.0);
    }
}
