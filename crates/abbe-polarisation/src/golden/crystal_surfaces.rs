//! Amplitudes at the surfaces of crystals.

use super::crystals::{axis, surface};
use super::{golden, numbers, pairs};
use crate::crystal::{Crystal, CrystalMode, CrystalSurface, SurfaceAmplitudes, UniaxialIndices};
use crate::surface::SurfaceMatrices;
use abbe_optics::thin_film::response;
use glam::DVec3;

fn travel(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, -cos)
}

#[test]
fn amplitudes_at_crystals_are_golden() {
    let file = golden("birefringence.json");
    let (absolute, degrees) = (file.tolerance("amplitudes_absolute"), file.tolerance("angles_deg"));
    file.check("fresnel_uniaxial", |row| {
        let surface = surface(row, axis(row));
        let mut compared = Vec::new();
        for (i, angle) in numbers(&row["angle_deg"]).into_iter().enumerate() {
            let found = surface.from_outside(travel(angle));
            let [s, p] = found.outside;
            let amplitudes = [(s[0], "r_ss"), (p[1], "r_pp"), (s[1], "r_ps"), (p[0], "r_sp")];
            for (amplitude, key) in amplitudes {
                assert!(amplitude.im.abs() < 1e-15);
                compared.extend(pairs(&[amplitude.re], &row[key][i], absolute));
            }
            for (incident, letter) in ["s", "p"].into_iter().enumerate() {
                let reflected = found.outside_power[incident].iter().sum();
                compared.extend(pairs(&[reflected], &row[format!("R_{letter}")][i], absolute));
                for (mode, name) in ["To", "Te"].into_iter().enumerate() {
                    let power = found.inside_power[incident][mode];
                    compared.extend(pairs(&[power], &row[format!("{name}_{letter}")][i], absolute));
                }
            }
        }
        if let Some(known) = row.get("brewster_deg").filter(|known| known.is_number()) {
            let amplitude = |angle: f64| surface.from_outside(travel(angle)).outside[1][1].re;
            let (mut low, mut high) = (30.0, 80.0);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if amplitude(middle) > 0.0 { low = middle } else { high = middle }
            }
            compared.extend(pairs(&[low], known, degrees));
        }
        compared
    });
}

/// Axes in general and in special directions.
fn axes() -> [DVec3; 5] {
    [DVec3::Z, DVec3::X, DVec3::Y, DVec3::new(0.3, -0.5, 0.7).normalize(), DVec3::new(-0.6, 0.2, 0.1).normalize()]
}

fn surfaces() -> impl Iterator<Item = CrystalSurface> {
    let indices = ["calcite", "rutile"].map(|name| Crystal::find(name).unwrap().at(589.2938));
    indices.into_iter().flat_map(|indices| axes().map(|axis| CrystalSurface { indices, axis, outside: 1.0 }))
}

fn power(found: &SurfaceAmplitudes, incident: usize) -> f64 {
    found.outside_power[incident].iter().chain(&found.inside_power[incident]).sum()
}

#[test]
fn each_wave_at_a_crystal_conserves_power() {
    for surface in surfaces() {
        for k in [0.0, 0.2, 0.7, 0.99, 1.1, 1.4, 1.47] {
            for azimuth in [0.0, 1.0, 2.5, 4.0_f64] {
                let (sin, cos) = azimuth.sin_cos();
                let tangential = DVec3::new(k * cos, k * sin, 0.0);
                let inside = surface.from_inside(tangential);
                for i in 0..2 {
                    assert!((power(&inside, i) - 1.0).abs() < 1e-12, "{surface:?} {tangential}: {inside:?}");
                }
                assert!(k < 1.0 || inside.outside_power == [[0.0; 2]; 2]);
                if k < 1.0 {
                    let travel = DVec3::new(tangential.x, tangential.y, -f64::sqrt(1.0 - k * k));
                    let outside = surface.from_outside(travel);
                    assert!((0..2).all(|i| (power(&outside, i) - 1.0).abs() < 1e-12), "{surface:?}: {outside:?}");
                }
            }
        }
    }
}

/// Power from mode i outside to mode j inside equals that on the reversed path, which has the
/// opposite tangential component.
#[test]
fn powers_at_a_crystal_are_reciprocal() {
    for surface in surfaces() {
        for tangential in [DVec3::new(0.3, 0.4, 0.0), DVec3::new(-0.8, 0.1, 0.0)] {
            let travel = DVec3::new(tangential.x, tangential.y, -(1.0 - tangential.length_squared()).sqrt());
            let (there, back) = (surface.from_outside(travel), surface.from_inside(-tangential));
            let inward = surface.from_inside(tangential);
            for i in 0..2 {
                for j in 0..2 {
                    assert!((there.inside_power[i][j] - back.outside_power[j][i]).abs() < 1e-12);
                    assert!((inward.inside_power[i][j] - back.inside_power[j][i]).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn a_crystal_without_birefringence_is_a_glass() {
    let indices = UniaxialIndices { ordinary: 1.5, extraordinary: 1.5 };
    for axis in axes() {
        let surface = CrystalSurface { indices, axis, outside: 1.0 };
        for degrees in [5.0, 40.0, 56.0, 85.0_f64] {
            let found = surface.from_outside(travel(degrees));
            let known = SurfaceMatrices::dielectric(degrees.to_radians().cos(), 1.0, 1.5).reflected;
            assert!((found.outside_power[0][0] - known.s).abs() < 1e-12);
            assert!((found.outside_power[1][1] - known.p).abs() < 1e-12);
            assert!(found.outside_power[0][1] + found.outside_power[1][0] < 1e-20);
            let cross = found.outside[0][0] * found.outside[1][1].conjugate();
            assert!((cross - known.cross).norm_squared() < 1e-24);
        }
    }
}

/// With the axis along the normal, the ordinary wave is s and the extraordinary one p, also in
/// total reflection.
#[test]
fn internal_reflection_in_a_glass_has_fresnels_amplitudes() {
    let indices = UniaxialIndices { ordinary: 1.5, extraordinary: 1.5 };
    let surface = CrystalSurface { indices, axis: DVec3::Z, outside: 1.0 };
    for k in [0.3_f64, 0.9, 1.2, 1.4] {
        let found = surface.from_inside(DVec3::X * k).inside;
        let cos = (1.0 - (k / 1.5).powi(2)).sqrt();
        let known = response(cos, 1.5, std::iter::empty(), 1.0.into(), 550.0);
        for (found, known) in [(found[0][0], known.s.reflected), (found[1][1], known.p.reflected)] {
            assert!((found - known).norm_squared() < 1e-24, "{k}: {found:?} {known:?}");
        }
    }
}

/// Waves obey Maxwell's equations: D = εE is perpendicular to k, and the ray to E and H.
#[test]
fn fields_and_rays_of_crystals_obey_maxwell() {
    for surface in surfaces() {
        for mode in [CrystalMode::Ordinary, CrystalMode::Extraordinary] {
            for upward in [false, true] {
                let wave = surface.wave(mode, DVec3::new(0.5, -0.3, 0.0), upward).unwrap();
                let (o2, e2) = (surface.indices.ordinary.powi(2), surface.indices.extraordinary.powi(2));
                let field = wave.electric;
                let displacement = field * o2 + surface.axis * ((e2 - o2) * field.dot(surface.axis));
                assert!((wave.k.cross(wave.k.cross(field)) + displacement).length() < 1e-12, "{surface:?} {mode:?}");
                let flow = field.cross(wave.k.cross(field)).normalize();
                assert!((flow - wave.ray).length() < 1e-12, "{surface:?} {mode:?}");
                assert!((wave.ray.z > 0.0) == upward);
            }
        }
    }
}
