//! Measurements: the readings of a scene's meters, in their units and with their errors.

use super::job::Job;
use super::monitor::Monitor;
use super::request::{Integrator, Request, StopRules};
use super::session::Rendered;
use abbe_scene::geometry::{Hit, Ray};
use abbe_scene::light::Light;
use abbe_scene::meter::{Meter, MeterGrid, MeterReading, Quantity, QuantityKind, Response, Sensor, SensorShape};
use abbe_spectra::colour::{cct_duv, cri_in_steps, rendition_in_steps};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::hypot;
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer};
use abbe_transport::gather::{DirectLighting, Glare};
use abbe_transport::plan::CausticPlan;
use abbe_transport::sensor::{Reading, ReadingBands, ReadingSpectrum, SpectralBands, half_interval_with_degrees};
use glam::DVec3;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasurementReport {
    /// The meters, in the order of the scene file.
    pub meters: Vec<MeterReport>,
    /// The integrator: `path` or `photon`.
    pub integrator: &'static str,
    pub passes: u64,
    /// The time in s.
    pub seconds: f64,
    pub notes: Vec<String>,
    /// The notes that are warnings.
    #[serde(skip)]
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeterReport {
    pub name: String,
    pub quantity: &'static str,
    pub unit: &'static str,
    /// The centres of the spectral bands in nm, if the quantity is a spectrum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength_nm: Option<Vec<f64>>,
    pub points: Vec<PointReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<MeterGrid>,
    /// The mean of the readings. `None` for spectra.
    pub mean: Option<f64>,
    /// The uniformity U0: the least reading divided by the mean. `None` for spectra, for glare
    /// ratings, and if the mean is 0.
    pub uniformity: Option<f64>,
    /// The least reading divided by the largest reading. `None` if `uniformity` is `None`.
    pub least_to_largest: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointReport {
    /// The position in the unit of the scene file.
    pub position: [f64; 3],
    /// The normal, the axis or the direction of view.
    pub normal: Option<[f64; 3]>,
    pub value: Value,
    pub noise: Option<Value>,
    /// The magnitude of the bias, or the effect of the bands for a function of the spectrum.
    pub bias: Option<Value>,
    /// The interval that contains the true value with a probability of 95 %.
    pub interval_95: Option<[Value; 2]>,
    /// For a surface: lm for illuminance, W for irradiance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flux: Option<f64>,
    /// The area of the surface in m².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_m2: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    Number(f64),
    Spectrum(Vec<f64>),
}

/// The relative error of every reading at which a measurement stops without a stop rule.
const DEFAULT_ERROR: f64 = 0.003;

/// Returns the stop rules of a measurement without its own. A pass with photons takes much longer
/// than one of the path tracer.
fn default_stop(integrator: Integrator) -> StopRules {
    let passes = match integrator {
        Integrator::Path => 2048,
        Integrator::Photon => 128,
    };
    StopRules { passes: Some(passes), time: None, target_error: Some(DEFAULT_ERROR) }
}

impl Job {
    /// Notes a point sensor in a hollow, where photons through glass may not reach its disk.
    fn note_of_hollows(&self, integrator: Integrator) -> Option<String> {
        /// The distance at which the surface below a sensor is found, by the radius of the scene;
        /// more than the shift of sensors above surfaces.
        const SEARCH_FRACTION: f64 = 1e-6;
        /// In a hollow, the surface beside a sensor is nearly parallel to the surface below it.
        const PARALLEL: f64 = 0.5;
        if integrator == Integrator::Path || self.plan.caustics == CausticPlan::Absent {
            return None;
        }
        let scene = &self.scene;
        let search_m = SEARCH_FRACTION * scene.radius_m;
        let hollow = |sensor: &Sensor| {
            let SensorShape::Point(position, Response::Plane(normal)) = sensor.shape else { return None };
            let find = |direction: DVec3, length_m: f64| {
                scene.geometry.intersect(&Ray { origin: position, direction }, None, length_m)
            };
            let below = find(-normal, search_m)?;
            let aside = normal.any_orthonormal_vector();
            let sides = [aside, -aside, normal.cross(aside), -normal.cross(aside)];
            let around = |hit: Hit| hit.object == below.object && hit.normal.dot(below.normal).abs() > PARALLEL;
            sides.into_iter().filter_map(|side| find(side, scene.radius_m)).any(around).then_some(below.object)
        };
        let object = scene.camera.sensors().iter().find_map(hollow)?;
        Some(format!(
            "a meter reads a point of the hollow surface {}; light that glass or mirrors focus there may be missing, \
             and a meter with `surface` reads it",
            scene.objects[object as usize].name
        ))
    }

    /// Returns an error if a meter measures glare and a lamp has no luminous surface.
    fn check_luminaires(&self) -> Result<()> {
        let measures = self.scene.meters.iter().any(|meter| meter.quantity == Quantity::UnifiedGlareRating);
        match self.scene.lights.iter().find(|light| measures && light.has_infinite_luminance()) {
            Some(light) => Err(Error::input(format!(
                "a meter measures the glare rating, but the light {} has no luminous surface",
                light.name
            ))
            .expected("an object with `emission`, or a luminaire with a luminous opening")),
            None => Ok(()),
        }
    }

    /// Estimates the glare at a sensor. A moving scene is as when the shutter opens.
    fn glare_at(&self, number: usize) -> [Glare; REPLICATES] {
        let scene = &self.scene;
        let eye = scene.sensor_point(&scene.camera.sensors()[number], [0.0; 4]);
        DirectLighting::tracked(scene, self.selector(), self.plan.media_plan).glare(scene, &eye, self.budget.seed)
    }

    /// Measures with all meters on the current thread pool, by default with the integrator that
    /// suits them. Also returns true if the monitor ended the measurement before a stop rule was
    /// satisfied.
    pub fn measure(
        &self,
        integrator: Option<Integrator>,
        stop: StopRules,
        monitor: &mut dyn Monitor,
    ) -> Result<(MeasurementReport, bool)> {
        let needs_sky = self.scene.meters.iter().any(|meter| meter.quantity == Quantity::DaylightFactor);
        let sky_lx = if needs_sky { sky_illuminance_lx(&self.scene.lights) } else { 0.0 };
        if needs_sky && sky_lx <= 0.0 {
            let error = Error::input("a meter measures the daylight factor, but the scene has no sky");
            return Err(error.expected("a light `sky` or `environment`"));
        }
        self.check_luminaires()?;
        let integrator = integrator.unwrap_or_else(|| self.integrator_for_meters());
        let stop = if stop == StopRules::default() { default_stop(integrator) } else { stop };
        let Rendered { stats, run, interrupted, .. } = self.render(Request { integrator, stop }, monitor)?;
        let mut readings = run.readings();
        if let Some((target, errors)) = stop.target_error.zip(run.errors()) {
            let widening = errors.whole.widening(target);
            readings.iter_mut().for_each(|reading| reading.widening = widening);
        }
        let errors_are_unknown = self.errors_are_unknown(integrator);
        // The statistics contain the note if the errors are unknown.
        let missing_light = self.note_of_missing_light(integrator).filter(|_| !errors_are_unknown);
        let mut rest = 0..readings.len();
        let meters = self.scene.meters.iter().map(|meter| {
            let own: Vec<usize> = rest.by_ref().take(meter.readings.len()).collect();
            let point = |(known, &number): (&MeterReading, &usize)| {
                let (quantity, reading) = (meter.quantity, &readings[number]);
                let mut point = point(quantity, known, reading, sky_lx);
                match (quantity.kind(), run.reading_spectrum(number)) {
                    (QuantityKind::Spectrum, Some(spectrum)) => {
                        with_spectrum(
                            &mut point,
                            &spectrum.merged(QuantityKind::Spectrum.bands() as usize),
                            known.factor,
                            reading,
                        );
                    }
                    (QuantityKind::OfSpectrum, Some(spectrum)) => {
                        with_function_of_spectrum(&mut point, &spectrum, quantity, reading);
                    }
                    (QuantityKind::Integral, _) | (_, None) => {}
                }
                if errors_are_unknown || reading.noise == Some(0.0) && reading.value == 0.0 {
                    // Light that no path found is neither in the reading nor in its noise.
                    (point.bias, point.interval_95) = (None, None);
                }
                if quantity == Quantity::UnifiedGlareRating {
                    with_glare(&mut point, &self.glare_at(number));
                }
                point
            };
            report(meter, meter.readings.iter().zip(&own).map(point).collect())
        });
        let meters = meters.collect();
        let (passes, seconds) = (stats.passes, stats.seconds.total);
        let missing: Vec<String> = missing_light.into_iter().chain(self.note_of_hollows(integrator)).collect();
        let notes = [self.scene.notes.as_slice(), &stats.notes, &missing].concat();
        let warnings = [self.scene.warnings.as_slice(), &stats.warnings].concat();
        Ok((MeasurementReport { meters, integrator: integrator.word(), passes, seconds, notes, warnings }, interrupted))
    }
}

fn report(meter: &Meter, points: Vec<PointReport>) -> MeterReport {
    let numbers: Option<Vec<f64>> = points
        .iter()
        .map(|point| match point.value {
            Value::Number(number) => Some(number),
            Value::Spectrum(_) => None,
        })
        .collect();
    let mean = numbers.as_ref().map(|numbers| numbers.iter().sum::<f64>() / numbers.len() as f64);
    let least = numbers.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let largest = numbers.iter().flatten().copied().fold(0.0, f64::max);
    let spectral = meter.quantity.kind() == QuantityKind::Spectrum;
    let wavelength_nm = spectral.then(|| SpectralBands::centres_nm(QuantityKind::Spectrum.bands() as usize));
    // The logarithms of the glare rating have no ratios.
    let divisor = mean.filter(|&mean| mean > 0.0 && meter.quantity != Quantity::UnifiedGlareRating);
    MeterReport {
        name: meter.name.clone(),
        quantity: meter.quantity.name(),
        unit: meter.quantity.unit(),
        wavelength_nm,
        points,
        mean,
        grid: meter.grid,
        uniformity: divisor.map(|mean| least / mean),
        least_to_largest: divisor.map(|_| least / largest),
    }
}

fn point(quantity: Quantity, known: &MeterReading, reading: &Reading, sky_lx: f64) -> PointReport {
    let (mean, flux) = (known.factor * quantity.scale(), known.area_m2);
    let per_value = if quantity.is_flux() {
        mean * flux.unwrap_or(1.0)
    } else if quantity == Quantity::DaylightFactor {
        100.0 * mean / sky_lx
    } else {
        mean
    };
    let half_interval = reading.half_interval_95();
    PointReport {
        position: known.position.to_array(),
        normal: known.normal.map(|normal| normal.to_array()),
        value: Value::Number(reading.value * per_value),
        noise: reading.noise.map(|noise| Value::Number(noise * per_value)),
        bias: reading.bias.map(|bias| Value::Number(bias * per_value)),
        interval_95: half_interval.map(|half| {
            let ends = [reading.value - half, reading.value + half];
            ends.map(|end| Value::Number(end.max(0.0) * per_value))
        }),
        flux: flux.filter(|_| !quantity.is_flux()).map(|area| reading.value * mean * area),
        area_m2: flux,
    }
}

/// Replaces the illuminance of a point by the glare rating. `estimates` are independent.
fn with_glare(point: &mut PointReport, estimates: &[Glare; REPLICATES]) {
    let number = |value: &Value| match value {
        Value::Number(number) => *number,
        Value::Spectrum(_) => f64::NAN,
    };
    let lx = number(&point.value);
    let ends_lx = point.interval_95.as_ref().map(|ends| ends.each_ref().map(number));
    let count = REPLICATES as f64;
    let mean = |of: fn(&Glare) -> f64| estimates.iter().map(of).sum::<f64>() / count;
    let glare = Glare { sum: mean(|glare| glare.sum), direct_lx: mean(|glare| glare.direct_lx) };
    let Some(rating) = glare.rating(lx) else {
        (point.value, point.noise, point.bias, point.interval_95) = (Value::Number(f64::NAN), None, None, None);
        return;
    };
    let deviation = |estimate: &Glare| estimate.rating(lx).map_or(f64::INFINITY, |one| one - rating);
    let squares: f64 = estimates.iter().map(deviation).map(|deviation| deviation * deviation).sum();
    let of_glare = (squares / (count * (count - 1.0))).sqrt();
    let half = half_interval_with_degrees(of_glare, 0.0, count - 1.0);
    // More light in the background means less glare.
    let end = |lx: f64, sign: f64| Some(Value::Number(rating + sign * hypot(glare.rating(lx)? - rating, half)));
    point.interval_95 = ends_lx.and_then(|[low, high]| Some([end(high, -1.0)?, end(low, 1.0)?]));
    let slope = glare.slope(lx);
    let noise = |lx: &Value| Value::Number(hypot(slope * number(lx), of_glare));
    let bias = |lx: &Value| Value::Number(slope * number(lx));
    (point.noise, point.bias) = (point.noise.as_ref().map(noise), point.bias.as_ref().map(bias));
    point.value = Value::Number(rating);
}

fn with_spectrum(report: &mut PointReport, spectrum: &ReadingSpectrum, factor: f64, reading: &Reading) {
    let values: Vec<f64> = spectrum.mean.values.iter().map(|value| value * factor).collect();
    report.value = Value::Spectrum(values.clone());
    let noise: Option<Vec<f64>> =
        (0..values.len()).map(|band| spectrum.noise_of(|bands| Some(bands.values[band] * factor))).collect();
    // The bias is known only for the sum of all bands. Every band gets the same relative bias.
    let relative_bias = reading.bias.filter(|_| reading.value > 0.0).map_or(0.0, |bias| bias / reading.value);
    let bias: Vec<f64> = values.iter().map(|value| value * relative_bias).collect();
    report.interval_95 = noise.as_ref().map(|noise| {
        let half =
            |band: usize| half_interval_with_degrees(reading.widening * noise[band], bias[band], spectrum.degrees());
        let halves: Vec<f64> = (0..values.len()).map(half).collect();
        [-1.0, 1.0].map(|sign| {
            Value::Spectrum(values.iter().zip(&halves).map(|(value, half)| (value + sign * half).max(0.0)).collect())
        })
    });
    (report.noise, report.bias) = (noise.map(Value::Spectrum), Some(Value::Spectrum(bias)));
}

/// The step in nm in which a reference illuminant is summed.
const REFERENCE_STEP_NM: u32 = 1;

/// Writes a function of the spectrum of a reading into its report.
fn with_function_of_spectrum(
    report: &mut PointReport,
    spectrum: &ReadingSpectrum,
    quantity: Quantity,
    reading: &Reading,
) {
    let of = |bands: &ReadingBands, xyz: Option<[f64; 3]>| {
        let light = bands.light();
        let temperature = cct_duv(xyz.unwrap_or_else(|| Observer::cie1931().xyz(&light)))?;
        if quantity == Quantity::ColourRendering {
            cri_in_steps(&light, temperature, REFERENCE_STEP_NM).map(|rendering| rendering.ra)
        } else if quantity == Quantity::Tm30Rf {
            rendition_in_steps(&light, REFERENCE_STEP_NM).map(|rendition| rendition.rf)
        } else if quantity == Quantity::Tm30Rg {
            rendition_in_steps(&light, REFERENCE_STEP_NM).map(|rendition| rendition.rg)
        } else {
            Some(temperature.cct_k)
        }
    };
    // The bands approximate the spectrum, but the colour is exact. The error of the bands is
    // estimated by its change when they become twice as wide.
    let value = of(&spectrum.mean, Some(reading.xyz));
    let wide_bands = spectrum.mean.merged(spectrum.mean.values.len() / 2);
    let of_wide_bands = of(&wide_bands, Some(reading.xyz));
    let bias = value.zip(of_wide_bands).map(|(value, wide)| (value - wide).abs());
    let noise = spectrum.noise_of(|bands| of(bands, None));
    report.value = Value::Number(value.unwrap_or(f64::NAN));
    (report.noise, report.bias) = (noise.map(Value::Number), bias.map(Value::Number));
    report.interval_95 = value.zip(noise).map(|(value, noise)| {
        let half = half_interval_with_degrees(reading.widening * noise, bias.unwrap_or(0.0), spectrum.degrees());
        [value - half, value + half].map(Value::Number)
    });
}

/// Returns the horizontal illuminance in lx of all lights around the scene, without obstacles: the
/// integral of L cos θ over the upper hemisphere.
fn sky_illuminance_lx(lights: &[Light]) -> f64 {
    /// The steps in elevation and in azimuth: exact to 10⁻⁵ for skies without steps.
    const STEPS: [u32; 2] = [512, 512];
    let mut sum = 0.0;
    for light in lights.iter().filter(|light| light.surrounds()) {
        let photometric = LUMENS_PER_WATT * Observer::cie1931().xyz(&light.spectrum)[1];
        for i in 0..STEPS[0] {
            // Equal steps of sin² θ have equal integrals of cos θ.
            let sin2 = (f64::from(i) + 0.5) / f64::from(STEPS[0]);
            let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
            for j in 0..STEPS[1] {
                let azimuth = TAU * (f64::from(j) + 0.5) / f64::from(STEPS[1]);
                let (across, along) = abbe_spectra::math::elementary::sin_cos(azimuth);
                let direction = DVec3::new(sin * across, cos, sin * along);
                sum += photometric * light.le(direction).map_or(0.0, |(radiance, _)| radiance);
            }
        }
    }
    sum * PI / (f64::from(STEPS[0]) * f64::from(STEPS[1]))
}
