//! Comparisons with values of tmm 0.2.0 and pyElli 0.23.1.

use crate::crystal::{CrystalSurface, UniaxialIndices};
use crate::surface::EllipsometricAngles;
use abbe_optics::thin_film::{StackResponse, response};
use abbe_spectra::math::complex::Complex;
use glam::DVec3;

/// Air, MgF2, TiO2, silver and glass at 550 nm: r_s, r_p, t_s and t_p of tmm, and Ψ and Δ of
/// pyElli.
const FILMS: [(f64, [f64; 8], [f64; 2]); 2] = [
    (
        33.0,
        [
            -0.143_629_427_630_366_8,
            -0.728_116_901_903_648_1,
            0.054_505_325_150_297_77,
            0.708_874_193_566_356_4,
            -0.441_695_420_518_111_56,
            0.226_374_106_313_022_1,
            -0.486_133_127_431_121_64,
            0.192_546_197_101_216_1,
        ],
        [43.770_716_375_169_61, 173.237_837_124_035_88],
    ),
    (
        62.0,
        [
            -0.688_460_680_607_885_8,
            -0.489_933_197_231_357_5,
            0.255_044_621_357_030_8,
            0.601_988_415_417_874_1,
            -0.196_049_261_856_983_82,
            0.247_373_829_529_207,
            -0.387_916_552_552_378,
            0.232_358_173_481_820_58,
        ],
        [37.729_817_604_035_29, 148.397_943_958_187_74],
    ),
];

#[test]
fn films_agree_with_tmm_and_pyelli() {
    for (degrees, amplitudes, angles) in FILMS {
        let layers = [(1.38.into(), 99.8), (2.35.into(), 61.0), (Complex::new(0.06, 3.6), 18.0)];
        let cos = degrees.to_radians().cos();
        let StackResponse { s, p } = response(cos, 1.0, layers.into_iter(), 1.52.into(), 550.0);
        let found = [s.reflected, p.reflected, s.transmitted, p.transmitted].map(|z| [z.re, z.im]);
        let error = |i: usize| (found[i / 2][i % 2] - amplitudes[i]).abs();
        assert!((0..8).all(|i| error(i) < 1e-12), "{degrees}: {found:?}");
        let found = EllipsometricAngles::of(&s, &p);
        assert!((found.psi_deg - angles[0]).abs() + (found.delta_deg - angles[1]).abs() < 1e-10, "{found:?}");
    }
}

/// Calcite with a general axis at 589.3 nm: r_pp, r_ps (from s into p), r_sp and r_ss of pyElli,
/// whose y and z axes are opposite.
const CRYSTAL: [(f64, [f64; 4]); 3] = [
    (
        20.0,
        [0.223_966_093_414_372_62, 0.015_261_300_959_717_509, -0.005_198_886_208_320_702, -0.249_297_061_137_606_72],
    ),
    (
        55.0,
        [0.049_880_768_362_983_545, 0.026_627_703_759_489_47, 0.003_727_813_163_456_496_6, -0.411_003_422_767_164_6],
    ),
    (75.0, [-0.297_736_716_139_996_9, 0.026_274_373_058_459_942, 0.006_607_809_645_199_473, -0.662_263_025_726_701_8]),
];

#[test]
fn a_crystal_with_a_general_axis_agrees_with_pyelli() {
    let indices = UniaxialIndices { ordinary: 1.658_343_822_23, extraordinary: 1.486_130_254_95 };
    let axis = DVec3::new(0.3, 0.5, -0.7).normalize();
    let surface = CrystalSurface { indices, axis, outside: 1.0 };
    for (degrees, known) in CRYSTAL {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [s, p] = surface.from_outside(DVec3::new(sin, 0.0, -cos)).outside;
        let found = [p[1].re, -s[1].re, -p[0].re, s[0].re];
        assert!((0..4).all(|i| (found[i] - known[i]).abs() < 1e-12), "{degrees}: {found:?}");
    }
}
