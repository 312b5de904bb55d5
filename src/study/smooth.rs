//! Where a picture is smooth: there theory says how fast a kernel's error falls. At an edge it falls more slowly.

use crate::sensor::Picture;

/// Half the width of the windows that are looked at, in pixels.
const REACH: usize = 3;

/// In a smooth window the standard deviation of Y stays within this share of its mean, noise taken off.
const LEVEL: f64 = 0.1;

/// Windows darker than this share of the picture's mean tell nothing.
const DARKEST: f64 = 0.02;

/// The rule in words.
pub const RULE: &str = "pixels around which, in 7 × 7 of the reference, the standard deviation of Y (less its noise) is at most 10 % of the mean, \
                        and the mean at least 2 % of the picture's";

/// Whether each pixel lies in a smooth region; `noise` is the variance of each pixel's Y.
pub(super) fn regions(picture: &Picture, noise: &[f64]) -> Vec<bool> {
    let (width, height) = (picture.width, picture.height);
    let least = DARKEST * picture.mean_y();
    let is_smooth = |x: usize, y: usize| {
        if x < REACH || y < REACH || x + REACH >= width || y + REACH >= height {
            return false;
        }
        let window = || (y - REACH..=y + REACH).flat_map(|j| (x - REACH..=x + REACH).map(move |i| j * width + i));
        let count = window().count() as f64;
        let mean = window().map(|i| picture.xyz[i][1]).sum::<f64>() / count;
        let spread = window().map(|i| (picture.xyz[i][1] - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let noise = window().map(|i| noise[i]).sum::<f64>() / count;
        mean > least && spread - noise <= (LEVEL * mean).powi(2)
    };
    (0..width * height).map(|i| is_smooth(i % width, i / width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_are_smooth_and_edges_darkness_and_borders_are_not() {
        let mut picture = Picture::black(60, 20);
        for (i, xyz) in picture.xyz.iter_mut().enumerate() {
            let x = i % 60;
            // A gentle ramp, an edge at 30, and darkness from 45 on.
            xyz[1] = match x {
                0..30 => 10.0 + 0.2 * x as f64,
                30..45 => 40.0,
                _ => 0.01,
            };
        }
        let smooth = regions(&picture, &[0.0; 1200]);
        let row: Vec<usize> = (0..60).filter(|x| smooth[10 * 60 + x]).collect();
        assert_eq!(row, (3..27).chain(33..42).collect::<Vec<usize>>());
        assert!((0..60).all(|x| !smooth[2 * 60 + x] && !smooth[17 * 60 + x]));
    }
}
