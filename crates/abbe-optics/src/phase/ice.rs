//! The phase function of ice crystals in the air, which `data/media/ice.csv` holds.
//!
//! The crystals are hexagonal columns and plates of ice at −7 °C in all orientations, whose length
//! is 0.5 to 2 times their width. Rays follow geometrical optics, with the ordinary index and
//! without absorption: crystals refract by their prisms of 60° and 90°, which makes the halos of
//! 22° and 46°. As much light as they intercept is diffracted forwards. Discs of the same projected
//! area, whose radii have a lognormal distribution with a median of 50 µm and a standard deviation
//! of ln r of 0.26, stand for their shadows, and blur the light that leaves a crystal in its old
//! direction as well. The table is for parallel light, so the sun blurs the rendered halos as in
//! the sky. Crystals that prefer an orientation, and their sundogs and pillars, are not in it.

use super::table::{self, PhaseTable};
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

#[cfg(test)]
mod tests {
    use super::super::PhaseFunction;
    use super::super::mie::lognormal;
    use super::*;
    use crate::aperture::fraunhofer;
    use crate::glass::RefractiveIndex;
    use glam::{DVec2, DVec3};
    use std::f64::consts::{FRAC_PI_3, PI, TAU};
    use std::fmt::Write;

    /// A hexagonal prism with edges of length 1 around its axis z.
    struct Crystal {
        half_length: f64,
        /// The outward normals, and the distances from the centre.
        faces: [(DVec3, f64); 8],
    }

    impl Crystal {
        /// Takes the length divided by the width from corner to corner.
        fn new(length_to_width: f64) -> Self {
            let half_length = length_to_width;
            let faces = std::array::from_fn(|i| match i {
                6 => (DVec3::Z, half_length),
                7 => (-DVec3::Z, half_length),
                _ => {
                    let (sin, cos) = (FRAC_PI_3 * i as f64).sin_cos();
                    (DVec3::new(cos, sin, 0.0), 0.75_f64.sqrt())
                }
            });
            Self { half_length, faces }
        }

        /// Selects a point on the faces that light from the direction `travel` meets, in proportion
        /// to its power there. Returns the point and the face.
        fn point(&self, travel: DVec3, [u, v, w]: [f64; 3]) -> (DVec3, usize) {
            let area = |i: usize| if i < 6 { 2.0 * self.half_length } else { 1.5 * 3.0_f64.sqrt() };
            let powers: [f64; 8] = std::array::from_fn(|i| area(i) * (-travel.dot(self.faces[i].0)).max(0.0));
            let mut rest = u * powers.iter().sum::<f64>();
            let lit = |i: &usize| powers[*i] > 0.0;
            let last = (0..8).rev().find(lit).expect("a face that light meets");
            let face = (0..last).find(|&i| {
                rest -= powers[i];
                rest < 0.0
            });
            let face = face.unwrap_or(last);
            let (normal, distance) = self.faces[face];
            let point = if face < 6 {
                normal * distance + normal.cross(DVec3::Z) * (v - 0.5) + DVec3::Z * self.half_length * (2.0 * w - 1.0)
            } else {
                // A triangle of the hexagon, then a point in it.
                let (sector, v) = ((6.0 * v).floor(), (6.0 * v).fract());
                let corner = |i: f64| {
                    let (sin, cos) = (FRAC_PI_3 * (i + 0.5)).sin_cos();
                    DVec3::new(cos, sin, 0.0)
                };
                normal * distance + (corner(sector) * (1.0 - v) + corner(sector + 1.0) * v) * w.sqrt()
            };
            (point, face)
        }

        /// Calls `leaves` with each direction in which light leaves the crystal and its fraction,
        /// and for light without a reflection with the faces through which it entered and left.
        /// Stops when nearly all light has left.
        fn trace(
            &self,
            n: f64,
            travel: DVec3,
            (mut point, entered): (DVec3, usize),
            mut leaves: impl FnMut(DVec3, f64, Option<[usize; 2]>),
        ) {
            let normal = self.faces[entered].0;
            let Some((reflectance, mut inside)) = interface(travel, normal, 1.0 / n) else { return };
            leaves(travel - 2.0 * travel.dot(normal) * normal, reflectance, None);
            let mut power = 1.0 - reflectance;
            for reflections in 0..200 {
                let distance = |&(normal, distance): &(DVec3, f64)| {
                    let cos = inside.dot(normal);
                    if cos > 1e-12 { (distance - point.dot(normal)) / cos } else { f64::INFINITY }
                };
                let distances = self.faces.each_ref().map(distance);
                let left = (0..8).min_by(|&i, &j| distances[i].total_cmp(&distances[j])).expect("a face");
                point += inside * distances[left];
                let normal = self.faces[left].0;
                if let Some((reflectance, outside)) = interface(inside, -normal, n) {
                    leaves(outside, power * (1.0 - reflectance), (reflections == 0).then_some([entered, left]));
                    power *= reflectance;
                }
                if power < 1e-5 {
                    break;
                }
                inside -= 2.0 * inside.dot(normal) * normal;
            }
        }
    }

    /// Returns the reflectance for natural light and the refracted direction, or `None` for total
    /// reflection. `normal` is on the side of the light, and `ratio` the index there divided by the
    /// other.
    fn interface(travel: DVec3, normal: DVec3, ratio: f64) -> Option<(f64, DVec3)> {
        let cos = -travel.dot(normal);
        let square = 1.0 - ratio * ratio * (1.0 - cos * cos);
        if square <= 0.0 {
            return None;
        }
        let other = square.sqrt();
        let s = (ratio * cos - other) / (ratio * cos + other);
        let p = (cos - ratio * other) / (cos + ratio * other);
        Some((0.5 * (s * s + p * p), (ratio * travel + (ratio * cos - other) * normal).normalize()))
    }

    /// Calls `visit` with the crystal, the direction of the light and the point of evenly spread
    /// rays (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
    fn rays(count: u32, mut visit: impl FnMut(&Crystal, DVec3, (DVec3, usize))) {
        // The positive root of x⁷ = x + 1.
        let root = (0..64).fold(1.0_f64, |x, _| (1.0 + x).powf(1.0 / 7.0));
        for i in 0..count {
            let u: [f64; 6] = std::array::from_fn(|k| (0.5 + f64::from(i) * root.powi(-1 - k as i32)).fract());
            let crystal = Crystal::new(0.5 * 4.0_f64.powf(u[0]));
            let (z, phi) = (1.0 - 2.0 * u[1], TAU * u[2]);
            let radius = (1.0 - z * z).max(0.0).sqrt();
            let travel = DVec3::new(radius * phi.cos(), radius * phi.sin(), z);
            let point = crystal.point(travel, [u[3], u[4], u[5]]);
            visit(&crystal, travel, point);
        }
    }

    /// In multiples of 0.01°: densest in the forward peak and at the inner edges of the halos.
    fn angles() -> Vec<f64> {
        let parts = [(0, 200, 2), (200, 600, 10), (600, 2000, 50), (2000, 2500, 5), (2500, 4400, 50)];
        let parts = parts.into_iter().chain([(4400, 5000, 10), (5000, 14_000, 100), (14_000, 18_000, 50)]);
        let steps = |(from, to, step): (u32, u32, usize)| (from..to).step_by(step);
        parts.flat_map(steps).chain([18_000]).map(|hundredths| f64::from(hundredths) / 100.0).collect()
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
        rays(count, |crystal, travel, place| {
            for (column, &n) in indices.iter().enumerate() {
                crystal.trace(n, travel, place, |direction, power, _| {
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
        let radii = lognormal(50.0, 0.26, 40);
        let area: f64 = radii.iter().map(|(radius, fraction)| radius * radius * fraction).sum();
        let last = versines.len() - 1;
        for (column, sums) in sums.iter_mut().enumerate() {
            let diffracted = f64::from(count) + forward[column];
            for (i, (sum, degrees)) in sums.iter_mut().zip(angles()).enumerate() {
                let width = 0.5 * (versines[(i + 1).min(last)] - versines[i.saturating_sub(1)]);
                let airy = |(radius, fraction): &(f64, f64)| {
                    let wave_number = TAU * 1000.0 * radius / nm[column];
                    let place = DVec2::new(wave_number * degrees.to_radians().sin() / PI, 0.0);
                    let peak = wave_number * wave_number / (4.0 * PI);
                    radius * radius * fraction / area * peak * fraunhofer(None, place)
                };
                let peak: f64 = if degrees < 90.0 { radii.iter().map(airy).sum() } else { 0.0 };
                *sum = *sum / (TAU * width) + diffracted * peak;
            }
        }
        sums
    }

    /// The least deviations of a prism of ice with n = 1.31 are those of the two halos.
    #[test]
    fn prisms_of_60_and_90_degrees_deviate_least_at_the_halos() {
        let mut least = [f64::INFINITY; 2];
        rays(400_000, |crystal, travel, place| {
            crystal.trace(1.31, travel, place, |direction, _, faces| {
                let Some([entered, left]) = faces else { return };
                let cos = crystal.faces[entered].0.dot(crystal.faces[left].0);
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
        rays(20_000, |crystal, travel, place| {
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
            let at = |degrees: f64| table.eval(degrees.to_radians().cos(), nm);
            let brightest =
                (2000..2500).map(|i| f64::from(i) / 100.0).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
            assert!((edge..edge + 0.5).contains(&brightest), "{nm} nm: {brightest}° for {edge}°");
            assert!(at(edge - 0.1) < 0.35 * at(brightest), "{nm} nm: {} and {}", at(edge - 0.1), at(brightest));
        }
        // Compact crystals have mean cosines of 0.76 to 0.82 (Macke, Mueller & Raschke 1996).
        let mean = table.mean_cosine(550.0);
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
