//! The pixels along a line on the film.

use glam::DVec2;

/// Calls `visit(pixel, from, to)` for each pixel that the line from `a` to `b` crosses, with the
/// parts of the line, from 0 at `a` to 1 at `b`, at which it enters and leaves the pixel. `size` is
/// that of the film in pixels.
pub(super) fn for_each_pixel(a: DVec2, b: DVec2, size: DVec2, mut visit: impl FnMut(u32, f64, f64)) {
    let along = b - a;
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if along[axis] == 0.0 {
            if !(a[axis] >= 0.0 && a[axis] < size[axis]) {
                return;
            }
            continue;
        }
        let ends = [-a[axis] / along[axis], (size[axis] - a[axis]) / along[axis]];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    if from >= to {
        return;
    }
    // The first crossing of a grid line after `t`, and the step between crossings, on each axis.
    let last = size - 1.0;
    let start = a + along * from;
    let step = [0, 1].map(|axis| (1.0 / along[axis]).abs());
    let mut pixel = [0, 1].map(|axis| {
        let at = start[axis].floor();
        // A line that enters at the right or lower edge starts on the edge.
        at.clamp(0.0, last[axis])
    });
    let mut next = [0, 1].map(|axis| {
        if along[axis] == 0.0 {
            return f64::INFINITY;
        }
        let edge = if along[axis] > 0.0 { pixel[axis] + 1.0 } else { pixel[axis] };
        (edge - a[axis]) / along[axis]
    });
    let mut t = from;
    while t < to {
        let axis = usize::from(next[1] < next[0]);
        let end = next[axis].min(to);
        if end > t {
            visit(pixel[1] as u32 * size.x as u32 + pixel[0] as u32, t, end);
            t = end;
        }
        if next[axis] >= to {
            return;
        }
        pixel[axis] += along[axis].signum();
        if !(pixel[axis] >= 0.0 && pixel[axis] <= last[axis]) {
            return;
        }
        next[axis] += step[axis];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn visited(a: [f64; 2], b: [f64; 2]) -> Vec<(u32, f64, f64)> {
        let mut pixels = Vec::new();
        for_each_pixel(a.into(), b.into(), DVec2::new(4.0, 3.0), |pixel, from, to| pixels.push((pixel, from, to)));
        pixels
    }

    #[test]
    fn a_line_is_divided_where_it_crosses_pixels() {
        assert_eq!(visited([0.5, 1.5], [2.5, 1.5]), [(4, 0.0, 0.25), (5, 0.25, 0.75), (6, 0.75, 1.0)]);
        assert_eq!(visited([2.5, 1.5], [0.5, 1.5]), [(6, 0.0, 0.25), (5, 0.25, 0.75), (4, 0.75, 1.0)]);
        assert_eq!(visited([1.2, 1.2], [1.3, 1.8]), [(5, 0.0, 1.0)]);
    }

    #[test]
    fn parts_beside_the_film_are_left_out() {
        assert_eq!(visited([-1.0, 0.5], [1.0, 0.5]), [(0, 0.5, 1.0)]);
        assert_eq!(visited([3.5, 2.5], [5.5, 2.5]), [(11, 0.0, 0.25)]);
        assert!(visited([-1.0, -0.5], [5.0, -0.5]).is_empty());
        assert!(visited([5.0, -1.0], [5.0, 9.0]).is_empty());
    }

    /// The parts of a line cover its whole length on the film, each in the pixel of its middle.
    #[test]
    fn the_parts_cover_the_line() {
        let mut state = 0.37_f64;
        let mut random = || {
            state = (state * 997.13).fract();
            state
        };
        for _ in 0..10_000 {
            let [a, b] = [0, 1].map(|_| DVec2::new(6.0 * random() - 1.0, 5.0 * random() - 1.0));
            let mut end = None;
            for_each_pixel(a, b, DVec2::new(4.0, 3.0), |pixel, from, to| {
                assert!(from < to && end.is_none_or(|end: f64| (from - end).abs() < 1e-12));
                let middle = a + (b - a) * (0.5 * (from + to));
                assert_eq!(pixel, middle.y as u32 * 4 + middle.x as u32);
                end = Some(to);
            });
        }
    }
}
