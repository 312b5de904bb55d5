//! Finds the smooth regions of a picture. Only there the theoretical convergence rates of kernel
//! estimates hold; at an edge, the error falls more slowly.

use abbe_transport::sensor::Picture;

/// The window around a pixel extends this many pixels to every side.
const RADIUS_PX: usize = 3;

/// The largest standard deviation of Y in a smooth window, without the noise, relative to the mean.
const LEVEL: f64 = 0.1;

/// The smallest mean of a smooth window, relative to the mean of the picture.
const DARKEST: f64 = 0.02;

pub const RULE: &str = "a pixel is smooth if, in the 7 × 7 pixels of the reference around it, the standard deviation of Y \
                        (without noise) is at most 10 % of the mean, and the mean is at least 2 % of the picture's mean";

/// Returns for each pixel whether it is in a smooth region. `noise` is the variance of Y.
pub(super) fn find(picture: &Picture, noise: &[f64]) -> Vec<bool> {
    let (width, height) = (picture.width, picture.height);
    let least = DARKEST * picture.mean_y();
    let is_smooth = |x: usize, y: usize| {
        if x < RADIUS_PX || y < RADIUS_PX || x + RADIUS_PX >= width || y + RADIUS_PX >= height {
            return false;
        }
        let window = || {
            (y - RADIUS_PX..=y + RADIUS_PX).flat_map(|j| (x - RADIUS_PX..=x + RADIUS_PX).map(move |i| j * width + i))
        };
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
    fn only_bright_ramps_away_from_edges_are_smooth() {
        let mut picture = Picture::black(60, 20);
        for (i, xyz) in picture.xyz.iter_mut().enumerate() {
            let x = i % 60;
            // A gentle ramp, an edge at column 30, and dark pixels from column 45 on.
            xyz[1] = match x {
                0..30 => 10.0 + 0.2 * x as f64,
                30..45 => 40.0,
                _ => 0.01,
            };
        }
        let smooth = find(&picture, &[0.0; 1200]);
        let row: Vec<usize> = (0..60).filter(|x| smooth[10 * 60 + x]).collect();
        assert_eq!(row, (3..27).chain(33..42).collect::<Vec<usize>>());
        assert!((0..60).all(|x| !smooth[2 * 60 + x] && !smooth[17 * 60 + x]));
    }
}
