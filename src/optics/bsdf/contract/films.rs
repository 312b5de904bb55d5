//! Cases of surfaces with thin films and of gratings.

use super::{BsdfCase, glass, ramp};
use crate::optics::bsdf::{Bsdf, Conductor, DiffractionGrating, Grooves, ThinDielectric};
use crate::optics::glass::RefractiveIndex;
use crate::optics::grating::{EfficiencyTable, Grating, GratingProfile};
use crate::optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use crate::spectrum::Spectrum;
use crate::texture::SurfaceScalar;

/// Returns a stack with a clear layer, or with the clear layer on a thin layer of a metal.
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
        into("coated glass", Bsdf::coated_dielectric(stack(600.0, false)), glass("N-SF10")),
        into("silvered glass", Bsdf::coated_dielectric(stack(100.0, true)), glass("N-SF10")),
        in_air("soap film", Bsdf::thin_film(stack(900.0, false))),
        in_air("silvered film", Bsdf::thin_film(stack(50.0, true))),
        in_air("coated pane", pane(stack(100.0, false))),
        in_air("silvered pane", pane(stack(100.0, true))),
        in_air("coated metal", metal(0.0)),
        in_air("coated rough metal", metal(0.3)),
    ]
}
