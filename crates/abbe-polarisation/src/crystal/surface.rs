//! The surface between an isotropic medium and a crystal.

use super::indices::UniaxialIndices;
use super::wave::{ComplexWave, CrystalMode, CrystalWave, across, complex, cross};
use abbe_spectra::math::complex::Complex;
use glam::DVec3;

/// The surface z = 0 of a crystal that fills z < 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalSurface {
    /// The indices of the crystal.
    pub indices: UniaxialIndices,
    /// The optic axis, a unit vector whose sign has no meaning.
    pub axis: DVec3,
    /// The index of the medium in z > 0.
    pub outside: f64,
}

/// What a surface makes of two incident waves with the same component of k along the surface: s and
/// p from outside, or the ordinary and the extraordinary wave from inside. The outer index of each
/// array is the incident wave.
///
/// Amplitudes are those of electric fields of length 1. From outside, s and p are as in
/// [`StokesFrame::perpendicular`](crate::StokesFrame::perpendicular), with s along z × k. Powers
/// are fractions of the incident flow along z, and those of an incident wave sum to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SurfaceAmplitudes {
    /// The amplitudes of s and p that leave into the outer medium.
    pub outside: [[Complex; 2]; 2],
    /// The amplitudes of the ordinary and the extraordinary wave that leave into the crystal.
    pub inside: [[Complex; 2]; 2],
    /// The powers of s and p that leave into the outer medium.
    pub outside_power: [[f64; 2]; 2],
    /// The powers of the ordinary and the extraordinary wave that leave into the crystal.
    pub inside_power: [[f64; 2]; 2],
}

const MODES: [CrystalMode; 2] = [CrystalMode::Ordinary, CrystalMode::Extraordinary];

impl CrystalSurface {
    /// Returns the wave of a mode in the crystal whose power flows along +z if `upward`, and along
    /// −z otherwise. `tangential` is the component of k along the surface, with z = 0: for light
    /// from outside, the index of the medium times the direction of travel. Returns `None` if the
    /// wave decays, because the component is too large for a travelling wave.
    pub fn wave(&self, mode: CrystalMode, tangential: DVec3, upward: bool) -> Option<CrystalWave> {
        let normal = self.indices.normal_component(mode, self.axis, tangential, upward);
        let k = tangential + DVec3::Z * normal.re;
        (normal.im == 0.0).then(|| self.indices.wave(mode, self.axis, k, across(tangential)))
    }

    /// Returns the waves that light of a direction of travel (z < 0) from outside excites in the
    /// crystal, first the ordinary one. Wave vectors are continuous along the surface.
    pub fn refracted(&self, travel: DVec3) -> [Option<CrystalWave>; 2] {
        MODES.map(|mode| self.wave(mode, tangential(travel * self.outside), false))
    }

    /// Returns the amplitudes and powers for light from outside with the direction of travel
    /// `travel`, a unit vector with z < 0.
    pub fn from_outside(&self, travel: DVec3) -> SurfaceAmplitudes {
        let tangential = tangential(travel * self.outside);
        self.solve(tangential, self.outer_waves(tangential, -1.0), 1.0)
    }

    /// Returns the amplitudes and powers for the ordinary and the extraordinary wave that arrive
    /// from inside with the component `tangential` of k along the surface (z = 0). All numbers of
    /// an incident wave that does not exist are 0.
    pub fn from_inside(&self, tangential: DVec3) -> SurfaceAmplitudes {
        self.solve(tangential, self.inner_waves(tangential, true), -1.0)
    }

    /// Returns s and p in the outer medium. They travel along `sign`·z.
    fn outer_waves(&self, tangential: DVec3, sign: f64) -> [ComplexWave; 2] {
        let normal = Complex::from(self.outside * self.outside - tangential.length_squared()).sqrt();
        let k = [tangential.x.into(), tangential.y.into(), normal * sign];
        let s = complex(across(tangential));
        [ComplexWave::new(k, s), ComplexWave::new(k, cross(k, s))]
    }

    fn inner_waves(&self, tangential: DVec3, upward: bool) -> [ComplexWave; 2] {
        MODES.map(|mode| {
            let normal = self.indices.normal_component(mode, self.axis, tangential, upward);
            let k = [tangential.x.into(), tangential.y.into(), normal];
            self.indices.complex_wave(mode, self.axis, k, across(tangential))
        })
    }

    /// Makes the tangential fields continuous. The incident waves are outside if `side` is 1, and
    /// inside if it is −1.
    fn solve(&self, tangential: DVec3, incident: [ComplexWave; 2], side: f64) -> SurfaceAmplitudes {
        let [up, down] = [self.outer_waves(tangential, 1.0), self.inner_waves(tangential, false)];
        let column = |wave: &ComplexWave, factor: f64| {
            let [e, h] = [wave.electric, wave.magnetic];
            [e[0] * factor, e[1] * factor, h[0] * factor, h[1] * factor]
        };
        // The fields of the waves outside minus those inside vanish.
        let unknown = [column(&up[0], 1.0), column(&up[1], 1.0), column(&down[0], -1.0), column(&down[1], -1.0)];
        let known = incident.map(|wave| column(&wave, -side));
        let solved = solve_columns(unknown, known);
        let mut found = SurfaceAmplitudes::default();
        for (i, (wave, amplitudes)) in incident.iter().zip(solved).enumerate() {
            let flow = wave.flow().abs();
            if wave.k[2].im != 0.0 || flow == 0.0 {
                continue;
            }
            let [s, p, o, e] = amplitudes;
            (found.outside[i], found.inside[i]) = ([s, p], [o, e]);
            let power = |amplitude: Complex, wave: &ComplexWave| amplitude.norm_squared() * wave.flow().abs() / flow;
            found.outside_power[i] = [power(s, &up[0]), power(p, &up[1])];
            found.inside_power[i] = [power(o, &down[0]), power(e, &down[1])];
        }
        found
    }
}

fn tangential(k: DVec3) -> DVec3 {
    DVec3::new(k.x, k.y, 0.0)
}

/// Solves two systems of four linear equations with the same matrix, which is given by its columns,
/// by elimination with pivots.
fn solve_columns(columns: [[Complex; 4]; 4], right: [[Complex; 4]; 2]) -> [[Complex; 4]; 2] {
    let mut rows: [[Complex; 6]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|j| if j < 4 { columns[j][i] } else { right[j - 4][i] }));
    for i in 0..4 {
        let size = |row: &[Complex; 6]| row[i].norm_squared();
        let largest = (i..4).max_by(|&a, &b| size(&rows[a]).total_cmp(&size(&rows[b]))).unwrap_or(i);
        rows.swap(i, largest);
        let pivot = rows[i][i];
        let row = rows[i].map(|element| element / pivot);
        rows[i] = row;
        for (j, other) in rows.iter_mut().enumerate() {
            let factor = other[i];
            if j != i {
                (0..6).for_each(|column| other[column] = other[column] - factor * row[column]);
            }
        }
    }
    [0, 1].map(|system| rows.map(|row| row[4 + system]))
}
