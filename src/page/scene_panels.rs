//! The data of a scene for the page: its text, plan, colours and lights.

use super::loaded_scene::LoadedScene;
use crate::api::PlanReport;
use abbe_optics::glass::catalogue;
#[cfg(feature = "view")]
use abbe_session::output::Metadata;
use abbe_session::render::{DisplaySettings, Job};
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{RgbSpace, Transfer, xy};
use abbe_spectra::spectrum::library;
use abbe_spectra::spectrum::{BAND_NM, Observer, Outside, Spectrum};
use abbe_transport::sensor::{Development, Picture};
use serde_json::{Value, json};

#[derive(Debug)]
pub(crate) struct ScenePanels {
    pub(crate) number: u64,
    pub(crate) display: DisplaySettings,
    /// The content of the page's panels as JSON.
    pub(crate) text: String,
}

/// The colour spaces that the page offers.
const PAGE_SPACES: [RgbSpace; 2] = [RgbSpace::Srgb, RgbSpace::DisplayP3];

/// The spectral locus is drawn for this range of wavelengths in nm.
const LOCUS_NM: (u32, u32) = (390, 700);

impl ScenePanels {
    pub(crate) fn new(number: u64, loaded: &LoadedScene) -> Self {
        let job = &loaded.job;
        let display = DisplaySettings::of(job);
        let scene: Value = serde_json::from_str(loaded.source.written()).unwrap_or(Value::Null);
        let content = json!({
            "file": loaded.source.path.file_name().map(|name| name.to_string_lossy()),
            "live": true,
            "scene": scene,
            "plan": PlanReport::of(job),
            "lights": job.scene.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
            "light": light_spectrum(job),
            "glasses": catalogue::names().collect::<Vec<_>>(),
            "spectra": library::names().collect::<Vec<_>>(),
        });
        Self::with_colours(number, display, job.scene.film.observer, content)
    }

    /// The panels of a saved picture. Its lights are unknown.
    #[cfg(feature = "view")]
    pub(crate) fn of_file(number: u64, name: &str, picture: &Picture, metadata: &Metadata) -> Self {
        let display = DisplaySettings::of_header(metadata).unwrap_or_else(DisplaySettings::automatic);
        let bands = picture.bands.as_ref().map_or(1, |bands| bands.centres_nm.len());
        let content = json!({
            "file": name,
            "live": false,
            "light": {"from_nm": BAND_NM.0, "to_nm": BAND_NM.1, "values": vec![0.0; bands]},
        });
        Self::with_colours(number, display, Observer::cie1931(), content)
    }

    /// Adds the colour spaces, tone curves and the spectral locus to the content.
    fn with_colours(number: u64, display: DisplaySettings, observer: &Observer, mut content: Value) -> Self {
        let locus: Vec<_> =
            (LOCUS_NM.0..=LOCUS_NM.1).step_by(5).map(|nm| (nm, xy(observer.xyz_bar(f64::from(nm))))).collect();
        let development = &display.development;
        content["number"] = json!(number);
        content["spaces"] = json!(PAGE_SPACES.map(|space| space_json(space, development)));
        content["space"] = json!(development.space.name());
        content["tone"] = json!(development.tone.name());
        content["tones"] = json!(ToneCurve::ALL.map(ToneCurve::name));
        content["bloom"] = json!(development.bloom.is_some());
        content["gamut"] = json!(development.gamut.name());
        content["locus"] = json!(locus);
        Self { number, display, text: content.to_string() }
    }

    /// Returns the reach of the shown picture, denoised or not, in each colour space of the page,
    /// by name.
    pub(crate) fn reaches(&self, picture: &Picture) -> Value {
        let shown = self.display.shown(picture);
        let reach = |space: RgbSpace| self.display.in_space(space).development.reach(&shown);
        PAGE_SPACES.map(|space| (space.name().to_string(), json!(reach(space)))).into_iter().collect::<Value>()
    }
}

/// Describes a colour space for the conversion on the page.
fn space_json(space: RgbSpace, development: &Development) -> Value {
    let development = Development { space, transfer: Transfer::OfSpace, ..*development };
    let limits = development.hue_limits();
    // Six digits are exact for the codes.
    let table = |values: &[f64]| values.iter().map(|value| (value * 1e6).round() / 1e6).collect::<Vec<_>>();
    json!({
        "name": space.name(),
        "matrix": development.matrix(),
        "hue_limits": {"edge": table(&limits.edge), "rounded": table(&limits.rounded), "locus": table(&limits.locus)},
        "own_matrix": space.picture_matrix(),
        "srgb_matrix": RgbSpace::Srgb.picture_matrix(),
        "rec2020_matrix": RgbSpace::Rec2020.picture_matrix(),
        "luminance_weights": space.luminance_weights(),
        "primaries_xy": space.primaries_xy(),
        "white_xy": space.white_xy(),
    })
}

/// Returns the power of all lights in W/nm in each band, and the limits of the bands.
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
