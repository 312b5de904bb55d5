//! The data of a scene for the page: its text, plan, colours and lights.

use super::host::LoadedScene;
use crate::api::PlanReport;
use crate::colour::tone::ToneCurve;
use crate::colour::{RgbSpace, xy};
use crate::render::{DisplaySettings, Job};
use crate::sensor::Development;
use crate::spectrum::{BAND_NM, Outside, Spectrum};
use serde_json::{Value, json};

/// A loaded scene as the page sees it.
#[derive(Debug)]
pub(super) struct ScenePanels {
    /// Counts the loaded scenes of the view.
    pub(super) number: u64,
    pub(super) display: DisplaySettings,
    /// The content of the page's panels as JSON.
    pub(super) text: String,
}

/// The spectral locus is drawn for this range of wavelengths in nm.
const LOCUS_NM: (u32, u32) = (390, 700);

impl ScenePanels {
    pub(super) fn new(number: u64, loaded: &LoadedScene) -> Self {
        let job = &loaded.job;
        let display = DisplaySettings::of(job);
        let observer = job.scene.film.observer;
        let locus: Vec<_> =
            (LOCUS_NM.0..=LOCUS_NM.1).step_by(5).map(|nm| (nm, xy(observer.xyz_bar(f64::from(nm))))).collect();
        let scene: Value = serde_json::from_str(&loaded.source.text).unwrap_or(Value::Null);
        let spaces = [RgbSpace::Srgb, RgbSpace::DisplayP3].map(|space| space_json(space, &display.development));
        let (plan, tones) = (PlanReport::of(job), ToneCurve::ALL.map(ToneCurve::name));
        let text = json!({
            "number": number,
            "file": loaded.source.path.file_name().map(|name| name.to_string_lossy()),
            "scene": scene,
            "plan": plan,
            "spaces": spaces,
            "space": display.development.space.name(),
            "tone": display.development.tone.name(),
            "tones": tones,
            "gamut": display.development.gamut.name(),
            "locus": locus,
            "light": light_spectrum(job),
        });
        Self { number, display, text: text.to_string() }
    }
}

/// Describes a colour space for the conversion on the page.
fn space_json(space: RgbSpace, development: &Development) -> Value {
    json!({
        "name": space.name(),
        "matrix": Development { space, ..*development }.matrix(),
        "own_matrix": space.picture_matrix(),
        "srgb_matrix": RgbSpace::Srgb.picture_matrix(),
        "rec2020_matrix": RgbSpace::Rec2020.picture_matrix(),
        "luminance_weights": space.luminance_weights(),
        "primaries_xy": space.primaries_xy(),
        "white_xy": space.white_xy(),
    })
}

/// Returns the spectral power of all lights in each band, in W/nm, with the limits of the bands in
/// nm.
fn light_spectrum(job: &Job) -> Value {
    let bands = job.scene.film.spectral_bands;
    let width_nm = (BAND_NM.1 - BAND_NM.0) / f64::from(bands.max(1));
    let lights: Vec<(f64, &Spectrum)> =
        job.scene.lights.iter().map(|light| (light.power_w(job.scene.extent()), &light.spectrum)).collect();
    let edge_nm = |band: u32| BAND_NM.0 + width_nm * f64::from(band);
    let power = |band: u32| {
        let window = Spectrum::table(&[edge_nm(band), edge_nm(band + 1)], &[1.0, 1.0], Outside::Zero);
        window.map_or(0.0, |window| {
            lights.iter().map(|(power_w, spectrum)| power_w * spectrum.product_integral(&window)).sum::<f64>()
                / width_nm
        })
    };
    json!({"from_nm": BAND_NM.0, "to_nm": BAND_NM.1, "values": (0..bands).map(power).collect::<Vec<_>>()})
}
