//! Cases of surfaces with thin films and of gratings.

use super::{BsdfCase, glass, grid, ramp};
use crate::bsdf::{Bsdf, Conductor, DiffractionGrating, Grooves, ThinDielectric, TransportMode};
use crate::glass::RefractiveIndex;
use crate::grating::{EfficiencyTable, Grating, GratingProfile};
use crate::texture::SurfaceScalar;
use crate::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;

/// Returns a stack with a clear layer, which may lie on a thin layer of a metal.
fn stack(thickness_nm: f64, with_metal: bool) -> FilmStack {
    let layer = |index, thickness_nm| FilmLayer { index, thickness_nm: SurfaceScalar::Uniform(thickness_nm) };
    let metal = OpticalIndex::absorbing(ramp(0.1, 0.3), ramp(2.0, 5.0)).unwrap();
    let clear = layer(OpticalIndex::Transparent(glass("water 20C")), thickness_nm);
    let layers = if with_metal { vec![clear, layer(metal, 25.0)] } else { vec![clear] };
    FilmStack::new(layers).unwrap()
}

pub(super) fn cases() -> Vec<BsdfCase> {
    let air = || RefractiveIndex::constant(1.0).unwrap();
    let into = |name, bsdf, behind| BsdfCase { name, bsdf, front: air(), behind };
    let in_air = |name, bsdf| into(name, bsdf, air());
    let coated = |films, alpha, glass: RefractiveIndex| BsdfCase {
        name: "",
        bsdf: Bsdf::coated_dielectric(films, &glass, alpha).unwrap(),
        front: air(),
        behind: glass,
    };
    let plain = || RefractiveIndex::constant(1.5).unwrap();
    let pane = |films| Bsdf::ThinDielectric(ThinDielectric::new(glass("N-BK7"), None).unwrap().with_coating(films));
    let metal =
        |alpha| Bsdf::Conductor(Conductor::coated(ramp(1.3, 2.2), ramp(1.8, 4.0), stack(300.0, false), alpha).unwrap());
    let grating = |profile, reflected, transmitted| {
        let [reflected, transmitted] = [reflected, transmitted].map(Spectrum::constant);
        let grating = Grating::new(600.0, profile).unwrap();
        Bsdf::Grating(DiffractionGrating::new(grating, reflected, transmitted, Grooves::Parallel(0.0)).unwrap())
    };
    // At oblique incidence, some of these orders do not propagate.
    let measured = vec![(-2, ramp(0.1, 0.2)), (0, ramp(0.3, 0.1)), (1, ramp(0.2, 0.5))];
    vec![
        in_air("blazed grating", grating(GratingProfile::Blazed { order: 1, blaze_nm: 500.0 }, 1.0, 0.0)),
        in_air(
            "sinusoidal grating",
            grating(GratingProfile::Sinusoidal { amplitude_rad: 1.8, at_nm: 550.0 }, 0.3, 0.6),
        ),
        in_air(
            "grating with measured efficiencies",
            grating(GratingProfile::Table(EfficiencyTable::new(measured).unwrap()), 0.5, 0.4),
        ),
        in_air("slits", grating(GratingProfile::BinaryAmplitude { duty: 0.4 }, 0.0, 1.0)),
        BsdfCase { name: "coated glass", ..coated(stack(600.0, false), 0.0, glass("N-SF10")) },
        BsdfCase { name: "silvered glass", ..coated(stack(100.0, true), 0.0, glass("N-SF10")) },
        BsdfCase { name: "coated rough glass", ..coated(stack(600.0, false), 0.2, glass("N-SF10")) },
        BsdfCase { name: "silvered rough glass", ..coated(stack(100.0, true), 0.3, glass("N-SF10")) },
        BsdfCase { name: "coated rough plain glass", ..coated(stack(100.0, false), 0.5, plain()) },
        BsdfCase { name: "silvered very rough glass", ..coated(stack(50.0, true), 1.0, plain()) },
        in_air("soap film", Bsdf::thin_film(stack(900.0, false))),
        in_air("silvered film", Bsdf::thin_film(stack(50.0, true))),
        in_air("coated pane", pane(stack(100.0, false))),
        in_air("silvered pane", pane(stack(100.0, true))),
        in_air("coated metal", metal(0.0)),
        in_air("coated rough metal", metal(0.3)),
    ]
}

#[test]
#[ignore = "nightly: 15 seconds of CPU time"]
fn clear_films_on_rough_glass_keep_the_energy() {
    let layer = |n: f64, thickness_nm: f64| FilmLayer {
        index: OpticalIndex::Transparent(RefractiveIndex::constant(n).unwrap()),
        thickness_nm: SurfaceScalar::Uniform(thickness_nm),
    };
    let stacks = [vec![layer(1.38, 100.0)], vec![layer(2.35, 60.0), layer(1.46, 95.0), layer(2.35, 60.0)]];
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for (alpha, n) in [(0.2, 1.5), (1.0, 1.1), (1.0, 2.4)] {
        let glass = RefractiveIndex::constant(n).unwrap();
        for films in &stacks {
            let bsdf = Bsdf::coated_dielectric(FilmStack::new(films.clone()).unwrap(), &glass, alpha).unwrap();
            let front = RefractiveIndex::constant(1.0).unwrap();
            let case = BsdfCase { name: "coated rough glass", bsdf, front, behind: glass.clone() };
            for cos in [0.1_f64, 0.4, 0.9, -0.1, -0.4, -0.9] {
                let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let scattered = |wi: DVec3| case.eval(wo, wi, TransportMode::Importance, 520.0) * wi.z.abs();
                let sum: f64 = grid::integrals(scattered).iter().sum();
                println!("alpha {alpha}, n = {n}, {} films, cosine {cos}: {sum:.5}", films.len());
                (least, most) = (least.min(sum), most.max(sum));
            }
        }
    }
    assert!(least > 0.99 && most < 1.00001, "from {least} to {most}");
}
