//! Bloom: the light that an eye scatters around bright parts of a picture.
//!
//! A display cannot show a lamp as bright as it is, so the eye of a viewer scatters much less light
//! than it would in front of the scene. Bloom adds this scattered light to the picture, and takes
//! it from the bright parts: the energy is conserved.

use std::f64::consts::PI;

use super::convolution::MirroredPlanes;
use super::picture::Picture;
use abbe_scene::Bloom;
use abbe_spectra::colour::Xyz;
use abbe_spectra::math::elementary::{hypot, ln_1p};

/// The pigmentation of a brown eye. Black eyes have 0, light blue ones 1.2.
const PIGMENT: f64 = 0.5;

/// The distance in pixels from the centre of the kernel up to which a pixel has subpixels.
const FINE_RADIUS: i64 = 8;

/// The subpixels of a pixel near the centre, in each direction.
const SUBPIXELS: i64 = 16;

/// Returns the point spread function of the eye in 1/sr at an angle from a point of light: the
/// total glare function of CIE 135/1 (J. Vos and T. van den Berg, "Disability glare", 1999). It
/// is not normalised, and holds up to 100°.
pub fn spread(eye: &Bloom, degrees: f64) -> f64 {
    let ageing = (eye.age / 70.0).powi(4);
    let square = |width: f64| 1.0 + (degrees / width).powi(2);
    let cubed = |width: f64| square(width) * square(width).sqrt();
    let core = 9.2e6 / cubed(0.0046) + 1.5e5 / cubed(0.045);
    let skirt = 400.0 / square(0.1) + 3e-8 * degrees * degrees;
    let pigment = 1300.0 / cubed(0.1) + 0.8 / square(0.1).sqrt();
    (1.0 - 0.08 * ageing) * core + (1.0 + 1.6 * ageing) * (skirt + PIGMENT * pigment) + 2.5e-3 * PIGMENT
}

/// Returns the integral of [`spread`] over the directions within a small angle.
fn spread_within(eye: &Bloom, degrees: f64) -> f64 {
    let ageing = (eye.age / 70.0).powi(4);
    let area = |width: f64| 2.0 * PI * width.to_radians() * width.to_radians();
    let square = |width: f64| (degrees / width).powi(2);
    let cubed = |width: f64| area(width) * (1.0 - 1.0 / (1.0 + square(width)).sqrt());
    let core = 9.2e6 * cubed(0.0046) + 1.5e5 * cubed(0.045);
    let skirt = 400.0 * 0.5 * area(0.1) * ln_1p(square(0.1)) + 3e-8 * 0.25 * area(degrees) * degrees * degrees;
    let pigment = 1300.0 * cubed(0.1) + 0.8 * area(0.1) * ((1.0 + square(0.1)).sqrt() - 1.0);
    (1.0 - 0.08 * ageing) * core
        + (1.0 + 1.6 * ageing) * (skirt + PIGMENT * pigment)
        + 2.5e-3 * PIGMENT * 0.5 * area(degrees)
}

/// Returns the XYZ of all pixels with the light that the eye scatters. The sum over all pixels
/// does not change. Pixels that are not finite scatter no light, and stay as they are.
pub fn apply(eye: &Bloom, picture: &Picture) -> Vec<Xyz> {
    let (width, height) = (picture.width, picture.height);
    let planes = MirroredPlanes::new((width, height));
    let pixel_degrees = eye.fov_degrees / width as f64;
    let kernel = planes.even_kernel(|x, y| kernel_value(eye, [x, y], pixel_degrees));
    let finite = |pixel: usize| {
        let xyz = picture.xyz[pixel];
        if xyz.iter().all(|value| value.is_finite()) { xyz } else { [0.0; 3] }
    };
    let xy = planes.convolved(&kernel, |pixel| [finite(pixel)[0], finite(pixel)[1]]);
    let z = planes.convolved(&kernel, |pixel| [finite(pixel)[2], 0.0]);
    let of_pixel = |((xyz, xy), z): ((&Xyz, [f64; 2]), [f64; 2])| {
        // Rounding may give values slightly below 0 where the picture is black.
        let spread = [xy[0], xy[1], z[0]].map(|value| value.max(0.0));
        if xyz.iter().all(|value| value.is_finite()) { spread } else { *xyz }
    };
    picture.xyz.iter().zip(xy).zip(z).map(of_pixel).collect()
}

/// Returns the value of the kernel at a pixel from its centre. All pixels fill the same angle.
fn kernel_value(eye: &Bloom, [x, y]: [usize; 2], pixel_degrees: f64) -> f64 {
    if [x, y] == [0, 0] {
        // The central pixel contains the core, so it is a disk of equal area with an exact
        // integral.
        return spread_within(eye, pixel_degrees / PI.sqrt());
    }
    kernel_pixel(eye, [x as i64, y as i64], pixel_degrees) * pixel_degrees.to_radians().powi(2)
}

/// Returns the mean of the point spread function over a pixel.
fn kernel_pixel(eye: &Bloom, [x, y]: [i64; 2], pixel_degrees: f64) -> f64 {
    let at = |x: f64, y: f64| spread(eye, pixel_degrees * hypot(x, y));
    if x.max(y) > FINE_RADIUS {
        return at(x as f64, y as f64);
    }
    let offset = |i: i64| (i as f64 + 0.5) / SUBPIXELS as f64 - 0.5;
    let rows =
        (0..SUBPIXELS).map(|j| (0..SUBPIXELS).map(|i| at(x as f64 + offset(i), y as f64 + offset(j))).sum::<f64>());
    rows.sum::<f64>() / (SUBPIXELS * SUBPIXELS) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Bloom = Bloom { fov_degrees: 40.0, age: Bloom::DEFAULT_AGE };

    fn lamp(width: usize, height: usize, at: (usize, usize)) -> Picture {
        let mut picture = Picture::black(width, height);
        picture.xyz[at.1 * width + at.0] = [3000.0, 2000.0, 1000.0];
        picture
    }

    #[test]
    fn bloom_conserves_energy_in_each_component() {
        for at in [(0, 0), (17, 3), (63, 40)] {
            let mut picture = lamp(64, 41, at);
            picture.xyz[100] = [1.0, 5.0, 20.0];
            let spread = apply(&EYE, &picture);
            for component in 0..3 {
                let sum = |xyz: &[Xyz]| xyz.iter().map(|xyz| xyz[component]).sum::<f64>();
                assert!((sum(&spread) / sum(&picture.xyz) - 1.0).abs() < 1e-12, "{at:?} {component}");
            }
        }
    }

    #[test]
    fn a_uniform_picture_stays_uniform() {
        let mut picture = Picture::black(30, 20);
        picture.xyz.fill([0.5, 2.0, 7.0]);
        for xyz in apply(&EYE, &picture) {
            assert!(xyz.iter().zip([0.5, 2.0, 7.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{xyz:?}");
        }
    }

    /// The light along a row is that of the glare function at its angles. In the middle of a
    /// picture of 401 pixels, the reflections of the lamp are 401 pixels away from it.
    #[test]
    fn the_profile_follows_the_glare_function() {
        let width = 401;
        let shown = apply(&EYE, &lamp(width, width, (200, 200)));
        let at = |x: usize, y: usize| spread(&EYE, EYE.fov_degrees / width as f64 * hypot(x as f64, y as f64));
        let expected = |x: usize| at(x, 0) + at(width - x, 0) + at(x, width) + at(width - x, width);
        let found = |x: usize| shown[200 * width + 200 + x][1];
        for pixels in [5, 20, 40, 80, 120, 160] {
            let ratio = found(pixels) / found(10) / (expected(pixels) / expected(10));
            assert!((ratio - 1.0).abs() < 0.02, "{pixels}: {ratio}");
        }
    }

    /// With the normalisation of CIE 135/1, 1 + p (0.0417 + 0.055 (A/70)⁴), the whole function has
    /// the integral 1.
    #[test]
    fn the_glare_function_is_nearly_normalised() {
        for age in [25.0, 70.0] {
            let bloom = Bloom { age, ..EYE };
            let ageing = (age / 70.0_f64).powi(4);
            let steps = 200_000;
            let step = (1e3_f64 / 1e-4).ln() / f64::from(steps);
            let ring = |i: i32| {
                let degrees = 1e-4 * (f64::from(i) * step).exp();
                let angle = degrees.to_radians();
                if degrees > 100.0 { 0.0 } else { spread(&bloom, degrees) * 2.0 * PI * angle.sin() * angle * step }
            };
            let whole = (0..steps).map(ring).sum::<f64>() / (1.0 + PIGMENT * (0.0417 + 0.055 * ageing));
            assert!((whole - 1.0).abs() < 0.06, "{age}: {whole}");
        }
    }

    #[test]
    fn the_integral_of_the_core_is_that_of_the_function() {
        for limit in [0.01, 0.1, 1.0] {
            let steps = 100_000;
            let ring = |i: i32| {
                let degrees = limit * (f64::from(i) + 0.5) / f64::from(steps);
                spread(&EYE, degrees) * 2.0 * PI * degrees.to_radians() * (limit / f64::from(steps)).to_radians()
            };
            let sum: f64 = (0..steps).map(ring).sum();
            assert!((spread_within(&EYE, limit) / sum - 1.0).abs() < 1e-3, "{limit}: {sum}");
        }
    }

    /// The central pixel has the integral of the core, which is much narrower than the pixel.
    #[test]
    fn most_light_stays_in_its_pixel() {
        let (width, middle) = (401, 200 * 401 + 200);
        let shown = apply(&EYE, &lamp(width, width, (200, 200)));
        let expected = spread_within(&EYE, EYE.fov_degrees / width as f64 / PI.sqrt()) / spread_within(&EYE, 20.0);
        assert!((shown[middle][1] / 2000.0 / expected - 1.0).abs() < 0.03, "{} {expected}", shown[middle][1]);
    }

    #[test]
    fn older_eyes_scatter_more() {
        let halo = |age: f64| apply(&Bloom { age, ..EYE }, &lamp(101, 101, (50, 50)))[50 * 101 + 60][1];
        assert!(halo(70.0) > 1.5 * halo(25.0));
    }

    #[test]
    fn pixels_that_are_not_finite_do_not_spread() {
        let mut picture = lamp(16, 16, (8, 8));
        picture.xyz[0] = [f64::NAN, 1.0, 1.0];
        let spread = apply(&EYE, &picture);
        assert!(spread[0][0].is_nan() && spread[1..].iter().flatten().all(|value| value.is_finite()));
    }
}
