//! The shutter: its opening time, its closing time, and its transmission as a function of time.

/// A shutter. If it opens and closes at the same time, there is no motion blur.
#[derive(Debug, Clone, PartialEq)]
pub struct Shutter {
    pub open_s: f64,
    pub close_s: f64,
    /// The transmission as a function of time, or `None` if the shutter is always fully open.
    curve: Option<ShutterCurve>,
}

/// The transmission as a piecewise linear function of time.
#[derive(Debug, Clone, PartialEq)]
struct ShutterCurve {
    /// Pairs of a time, 0 at opening and 1 at closing, and the transmission from 0 to 1.
    points: Vec<[f64; 2]>,
    /// For each point: the integral of the transmission from time 0 to this point.
    passed: Vec<f64>,
}

impl ShutterCurve {
    fn new(written: &[[f64; 2]]) -> Self {
        let mut points = written.to_vec();
        // The transmission is constant before the first point and after the last point.
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

    fn mean(&self) -> f64 {
        self.passed[self.passed.len() - 1]
    }

    /// The time (0 at opening, 1 at closing) at which the fraction `u` of all light has passed.
    fn inverse(&self, u: f64) -> f64 {
        let wanted = u * self.mean();
        let last = self.passed.len() - 2;
        let piece = self.passed.partition_point(|&passed| passed <= wanted).saturating_sub(1).min(last);
        let [[from, a], [to, b]] = [self.points[piece], self.points[piece + 1]];
        let rest = wanted - self.passed[piece];
        // Solves a·x + slope·x²/2 = rest, accurately even if a is near b or near 0.
        let slope = (b - a) / (to - from);
        let root = (a * a + 2.0 * slope * rest).max(0.0).sqrt();
        let x = if a + root > 0.0 { 2.0 * rest / (a + root) } else { 0.0 };
        (from + x).min(to)
    }
}

impl Shutter {
    /// Creates a shutter that opens at `open_s` and closes at `close_s` ≥ `open_s`. Each point of
    /// `curve` is an increasing time, from 0 at opening to 1 at closing, and a transmission from 0
    /// to 1, which must not be 0 everywhere.
    pub fn new(open_s: f64, close_s: f64, curve: Option<&[[f64; 2]]>) -> Self {
        Self { open_s, close_s, curve: curve.map(ShutterCurve::new) }
    }

    /// The exposure time in s: the integral of the transmission over time.
    pub fn exposure_s(&self) -> f64 {
        (self.close_s - self.open_s) * self.curve.as_ref().map_or(1.0, ShutterCurve::mean)
    }

    /// The time (in s) at which the fraction `u` (from 0 to 1) of all light has passed. For uniform
    /// `u`, the pdf of the times is proportional to the transmission.
    pub fn time_s(&self, u: f64) -> f64 {
        let fraction = self.curve.as_ref().map_or(u, |curve| curve.inverse(u));
        (1.0 - fraction) * self.open_s + fraction * self.close_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pdf_of_times_is_the_transmission() {
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
            // The mean time by Simpson's rule, which is exact for quadratic pieces.
            let held = ShutterCurve::new(curve).points;
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
    fn a_shutter_without_a_curve_may_have_zero_duration() {
        let shutter = Shutter::new(1.0, 3.0, None);
        assert_eq!([0.0, 0.25, 1.0].map(|u| shutter.time_s(u)), [1.0, 1.5, 3.0]);
        let instant = Shutter::new(0.7, 0.7, Some(&[[0.0, 0.0], [1.0, 1.0]]));
        assert_eq!([0.0, 0.3, 1.0].map(|u| instant.time_s(u)), [0.7; 3]);
        assert_eq!(instant.exposure_s(), 0.0);
    }
}
