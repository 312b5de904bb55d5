//! The plan of a render, as `abbe explain --json` prints it and the headers of pictures contain it.

use abbe_scene::camera::{ApertureDiffraction, Camera, DepthOfField};
use abbe_scene::facts::Facts;
use abbe_session::render::{DiffractionSetup, Job};
use abbe_transport::plan::explain;
use serde::Serialize;

/// The plan of a render.
#[derive(Debug, Serialize)]
pub struct PlanReport<'a> {
    effects: Vec<EffectReport<'a>>,
    wavelengths: &'static str,
    passes: u64,
    photons: u64,
    /// The number of photons within the gather radius of the first pass. Null if the scene sets
    /// this radius.
    nearest: Option<u32>,
    /// The gather radius of the first pass in m. Null if the scene does not set this radius.
    radius_m: Option<f64>,
    memory_bytes: u64,
    /// The largest distance, in pixels, that an object moves in the picture while the shutter is
    /// open. Null if nothing moves.
    motion_px: Option<f64>,
    camera: CameraReport,
    /// The objects and lights whose spectra come from RGB, and the lights with strong spectral
    /// lines. Null if one of the two lists is empty.
    guessed_colours: Option<GuessedColours>,
    notes: &'a [String],
}

#[derive(Debug, Serialize)]
struct GuessedColours {
    upsampled: Vec<String>,
    line_lamps: Vec<String>,
}

#[derive(Debug, Serialize)]
struct EffectReport<'a> {
    name: &'static str,
    state: &'static str,
    because: &'a str,
    field: &'static str,
    /// The cost of an effect that is on, or the render without one that is off.
    consequence: &'static str,
}

#[derive(Debug, Serialize)]
struct CameraReport {
    /// Horizontal and vertical.
    field_of_view_degrees: [f64; 2],
    /// Null for a pinhole.
    depth_of_field: Option<DepthReport>,
    /// Null for a pinhole.
    diffraction: Option<DiffractionReport>,
}

#[derive(Debug, Serialize)]
struct DiffractionReport {
    /// The diameter of the Airy disk in pixels: 2.44 λN on the film, for λ = 550 nm and the
    /// f-number N.
    airy_diameter_px: f64,
    /// True if the Airy disk is wider than a pixel.
    matters: bool,
    simulated: bool,
    /// The number of wavelength slices, of three sums per pixel each, on the film.
    slices: usize,
}

#[derive(Debug, Serialize)]
struct DepthReport {
    focus_m: f64,
    near_m: f64,
    /// The far limit of the depth of field in m. Null if this limit lies at infinity.
    far_m: Option<f64>,
    hyperfocal_m: f64,
    blur_at_infinity_px: f64,
}

impl CameraReport {
    fn of(camera: &Camera, slices: usize) -> Self {
        let diffraction = ApertureDiffraction::of(camera).map(|diffraction| DiffractionReport {
            airy_diameter_px: diffraction.airy_diameter_px(),
            matters: diffraction.matters(),
            simulated: slices > 0,
            slices,
        });
        let depth = DepthOfField::of(camera).map(|depth| {
            let DepthOfField { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px } = depth;
            let far_m = far_m.is_finite().then_some(far_m);
            DepthReport { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px }
        });
        let field_of_view_degrees = camera.field_of_view().map(f64::to_degrees);
        Self { field_of_view_degrees, depth_of_field: depth, diffraction }
    }
}

impl<'a> PlanReport<'a> {
    /// Collects the plan of a job.
    pub fn of(job: &'a Job) -> Self {
        let effects = job.rows.iter().map(|row| EffectReport {
            name: row.effect.name,
            state: row.state.word(),
            because: &row.because,
            field: row.effect.field,
            consequence: if row.state.is_on() { row.effect.cost } else { row.effect.absent },
        });
        let budget = &job.budget;
        let Facts { upsampled, line_lights: line_lamps, .. } = Facts::of(&job.scene);
        let slices = job.diffraction.as_ref().map_or(0, DiffractionSetup::slices);
        let both = !upsampled.is_empty() && !line_lamps.is_empty();
        Self {
            effects: effects.collect(),
            wavelengths: explain::wavelengths_word(&job.plan),
            passes: budget.passes,
            photons: budget.photons,
            nearest: budget.radius_m.is_none().then_some(budget.nearest),
            radius_m: budget.radius_m,
            memory_bytes: budget.memory_bytes,
            motion_px: job.scene.moves().then_some(budget.motion_px),
            camera: CameraReport::of(&job.scene.camera, slices),
            guessed_colours: both.then_some(GuessedColours { upsampled, line_lamps }),
            notes: &job.scene.notes,
        }
    }
}
