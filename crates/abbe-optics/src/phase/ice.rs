//! The phase function of ice crystals in the air, which `data/media/ice.csv` holds.
//!
//! The crystals are hexagonal columns and plates of ice at −7 °C in all orientations, whose length
//! is 0.5 to 2 times their width. An orientation counts by the area that the crystal turns to the
//! light, and each length as much as the others. Rays follow geometrical optics, with the ordinary
//! index and without absorption: crystals refract by their prisms of 60° and 90°, which makes the
//! halos of 22° and 46°. As much light as they intercept is diffracted forwards. Discs of the same projected
//! area, whose radii have a lognormal distribution with a median of 50 µm and a standard deviation
//! of ln r of 0.26, stand for their shadows, and blur the light that leaves a crystal in its old
//! direction as well. The table is for parallel light, so the sun blurs the rendered halos as in
//! the sky. [`oriented`](super::oriented) holds crystals that prefer an orientation.

use super::mie::lognormal;
use super::table::{self, PhaseTable};
use crate::aperture::fraunhofer;
use abbe_spectra::math::elementary::sin;
use glam::DVec2;
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

/// Returns the phase function of ice crystals.
pub fn ice() -> Arc<PhaseTable> {
    static TABLE: OnceLock<Arc<PhaseTable>> = OnceLock::new();
    TABLE
        .get_or_init(|| {
            let table = table::parse(include_str!("../../data/media/ice.csv")).expect("the built-in table is valid");
            Arc::new(table)
        })
        .clone()
}

/// The angles of the table in degrees, densest in the forward peak and at the inner edges of the
/// halos.
pub(super) fn angles() -> Vec<f64> {
    // In multiples of 0.01°.
    let parts = [(0, 200, 2), (200, 600, 10), (600, 2000, 50), (2000, 2500, 5), (2500, 4400, 50)];
    let parts = parts.into_iter().chain([(4400, 5000, 10), (5000, 14_000, 100), (14_000, 18_000, 50)]);
    let steps = |(from, to, step): (u32, u32, usize)| (from..to).step_by(step);
    parts.flat_map(steps).chain([18_000]).map(|hundredths| f64::from(hundredths) / 100.0).collect()
}

/// Returns the pdf per steradian of the light that crystals diffract, at each of [`angles`].
pub(super) fn diffraction(nm: f64) -> Vec<f64> {
    let radii = lognormal(50.0, 0.26, 40);
    let area: f64 = radii.iter().map(|(radius, fraction)| radius * radius * fraction).sum();
    let at = |degrees: f64| {
        let airy = |(radius, fraction): &(f64, f64)| {
            let wave_number = TAU * 1000.0 * radius / nm;
            let place = DVec2::new(wave_number * sin(degrees.to_radians()) / PI, 0.0);
            let peak = wave_number * wave_number / (4.0 * PI);
            radius * radius * fraction / area * peak * fraunhofer(None, place)
        };
        if degrees < 90.0 { radii.iter().map(airy).sum() } else { 0.0 }
    };
    angles().into_iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::super::crystal::{Crystal, evenly_spread};
    use super::super::{Deflection, PhaseFunction};
    use super::*;
    use crate::glass::RefractiveIndex;
    use glam::DVec3;
    use std::fmt::Write;

    /// Calls `visit` with the crystal, the direction of the light, the point of evenly spread rays,
    /// and the area that the crystal turns to the light, relative to its mean over all directions.
    fn rays(count: u32, mut visit: impl FnMut(&Crystal, DVec3, (DVec3, usize), f64)) {
        evenly_spread::<6>(count, |u| {
            let crystal = Crystal::new(0.5 * 4.0_f64.powf(u[0]));
            let (z, phi) = (1.0 - 2.0 * u[1], TAU * u[2]);
            let radius = (1.0 - z * z).max(0.0).sqrt();
            let travel = DVec3::new(radius * phi.cos(), radius * phi.sin(), z);
            let (point, face, area) = crystal.point(travel, [u[3], u[4], u[5]]);
            visit(&crystal, travel, (point, face), area / crystal.mean_area());
        });
    }

    fn versine(degrees: f64) -> f64 {
        2.0 * (0.5 * degrees).to_radians().sin().powi(2)
    }

    /// Returns the columns of the table, in 1/sr at any scale.
    fn columns(nm: &[f64], count: u32) -> Vec<Vec<f64>> {
        let ice = RefractiveIndex::catalogue("ice -7C").unwrap();
        let indices: Vec<f64> = nm.iter().map(|&nm| ice.n(nm)).collect();
        let versines: Vec<f64> = angles().into_iter().map(versine).collect();
        let mut sums = vec![vec![0.0; versines.len()]; nm.len()];
        let mut forward = vec![0.0; nm.len()];
        let mut intercepted = 0.0;
        rays(count, |crystal, travel, place, area| {
            intercepted += area;
            for (column, &n) in indices.iter().enumerate() {
                crystal.trace(n, travel, place, |direction, fraction, _| {
                    let power = area * fraction;
                    let versine = 0.5 * (direction - travel).length_squared();
                    if versine < 1e-12 {
                        forward[column] += power;
                        return;
                    }
                    let after = versines.partition_point(|&known| known <= versine).clamp(1, versines.len() - 1);
                    let t = (versine - versines[after - 1]) / (versines[after] - versines[after - 1]);
                    sums[column][after - 1] += power * (1.0 - t);
                    sums[column][after] += power * t;
                });
            }
        });
        let last = versines.len() - 1;
        for (column, sums) in sums.iter_mut().enumerate() {
            let diffracted = intercepted + forward[column];
            let peak = diffraction(nm[column]);
            for (i, (sum, peak)) in sums.iter_mut().zip(peak).enumerate() {
                let width = 0.5 * (versines[(i + 1).min(last)] - versines[i.saturating_sub(1)]);
                *sum = *sum / (TAU * width) + diffracted * peak;
            }
        }
        sums
    }

    /// The least deviations of a prism of ice with n = 1.31 are those of the two halos.
    #[test]
    fn prisms_of_60_and_90_degrees_deviate_least_at_the_halos() {
        let mut least = [f64::INFINITY; 2];
        rays(400_000, |crystal, travel, place, _| {
            crystal.trace(1.31, travel, place, |direction, _, faces| {
                let Some([entered, left]) = faces else { return };
                let cos = crystal.normals[entered].dot(crystal.normals[left]);
                let versine = 0.5 * (direction - travel).length_squared();
                let degrees = 2.0 * (0.5 * versine).sqrt().asin().to_degrees();
                // Faces at 120° form a prism of 60°, and those at 90° a prism of 90°.
                let number = usize::from(cos.abs() < 0.1);
                if (cos + 0.5).abs() < 0.1 || number == 1 {
                    least[number] = least[number].min(degrees);
                }
            });
        });
        let known =
            [60.0_f64, 90.0].map(|prism| 2.0 * (1.31 * (0.5 * prism).to_radians().sin()).asin().to_degrees() - prism);
        assert!((known[0] - 21.84).abs() < 0.01, "{}", known[0]);
        for (found, known) in least.iter().zip(known) {
            assert!((0.0..0.02).contains(&(found - known)), "{found}° for {known}°");
        }
    }

    /// All light that meets a crystal leaves it.
    #[test]
    fn crystals_keep_no_light() {
        let (mut sum, mut count) = (0.0, 0.0);
        rays(20_000, |crystal, travel, place, _| {
            count += 1.0;
            crystal.trace(1.31, travel, place, |_, power, _| sum += power);
        });
        assert!((sum / count - 1.0).abs() < 2e-3, "{}", sum / count);
    }

    /// The halo is red inside, and its inner edge is at the least deviation of each colour.
    #[test]
    fn the_built_in_halo_begins_at_the_least_deviation() {
        let table = PhaseFunction::Table(ice());
        let index = RefractiveIndex::catalogue("ice -7C").unwrap();
        for nm in [440.0, 540.0, 640.0] {
            let edge = 2.0 * (0.5 * index.n(nm)).asin().to_degrees() - 60.0;
            let at = |degrees: f64| table.eval(Deflection::horizontal(degrees.to_radians().cos()), nm);
            let brightest =
                (2000..2500).map(|i| f64::from(i) / 100.0).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
            assert!((edge..edge + 0.5).contains(&brightest), "{nm} nm: {brightest}° for {edge}°");
            assert!(at(edge - 0.1) < 0.35 * at(brightest), "{nm} nm: {} and {}", at(edge - 0.1), at(brightest));
        }
        // Compact crystals have mean cosines of 0.76 to 0.82 (Macke, Mueller & Raschke 1996).
        let mean = table.mean_cosine(550.0).expect("the crystals have all orientations");
        assert!((0.74..0.84).contains(&mean), "{mean}");
    }

    #[test]
    #[ignore = "minutes: traces millions of rays; with ABBE_BLESS it writes the table"]
    fn built_in_ice_table_matches_its_rays() {
        let bless = std::env::var_os("ABBE_BLESS").is_some();
        let nm: Vec<f64> = (360..=830).step_by(if bless { 20 } else { 160 }).map(f64::from).chain([830.0]).collect();
        let count = if bless { 6_000_000 } else { 4_000_000 };
        let (first, second) = nm.split_at(nm.len() / 2);
        let columns = std::thread::scope(|scope| {
            let other = scope.spawn(|| columns(second, count));
            [columns(first, count), other.join().unwrap()].concat()
        });
        if !bless {
            for (nm, column) in nm.iter().zip(&columns) {
                let found = PhaseTable::new(&angles(), &[*nm], std::slice::from_ref(column)).unwrap();
                for degrees in [0.0, 0.3, 10.0, 22.5, 30.0, 46.5, 100.0, 150.0] {
                    // A single angle receives a hundred rays of a million, a degree a thousand.
                    let mean = |table: &PhaseTable| {
                        let near = (-5..=5).map(|i| f64::to_radians(degrees + 0.1 * f64::from(i)));
                        near.map(|angle| table.eval(angle.cos(), *nm)).sum::<f64>() / 11.0
                    };
                    let (found, known) = (mean(&found), mean(&ice()));
                    assert!((found / known - 1.0).abs() < 0.05, "{degrees}° {nm} nm: {found}, {known}");
                }
            }
            return;
        }
        let mut text = String::from("angle_deg");
        nm.iter().for_each(|nm| write!(text, ",p_{nm}nm_per_sr").unwrap());
        for angle in angles() {
            write!(text, "\n{angle}").unwrap();
            for (nm, column) in nm.iter().zip(&columns) {
                let table = PhaseTable::new(&angles(), &[*nm], std::slice::from_ref(column)).unwrap();
                let digits = format!("{:.4e}", table.eval(angle.to_radians().cos(), *nm));
                write!(text, ",{}", digits.parse::<f64>().unwrap()).unwrap();
            }
        }
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/media/ice.csv");
        std::fs::write(path, text + "\n").unwrap();
    }
}
