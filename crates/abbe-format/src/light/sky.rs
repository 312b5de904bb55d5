//! Standard skies in the scene file.

use crate::prelude::*;
use crate::{JsonPath, SpectrumFile, TransformFile, check, date_time, forms, spectrum::SpectrumUse};
use abbe_scene::light::{GeographicPlace, StandardSky, SunDirection, SunPosition};
use abbe_spectra::error::Result;

/// The azimuth of the south in degrees.
const DEFAULT_AZIMUTH_DEG: f64 = 180.0;

/// The types of clear skies: the sun has a default illuminance.
const CLEAR_SKIES: std::ops::RangeInclusive<u32> = 11..=15;

/// A standard sky, with or without its sun. The position of the sun shapes the luminance of the
/// sky. State the position by `sun_elevation` and `sun_azimuth`, or by `place` and `time`. The sun
/// itself shines only if the key `sun` is present.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SkyFile {
    /// Number of the sky type: 1 to 15 for the types of the standard (1: overcast, 5: uniform, 12:
    /// clear), 16 for the traditional overcast sky.
    #[serde(rename = "type")]
    #[schemars(range(min = 1, max = 16))]
    pub kind: u32,
    /// Elevation of the sun above the horizon. This key, or `place` and `time`, are required with
    /// `sun`, and for all types with a luminance that depends on the sun: 2, 4 and 6 to 15.
    #[schemars(range(min = 0, max = 90), extend("x-unit" = "°"))]
    pub sun_elevation: Option<f64>,
    /// Azimuth of the sun from north (−z) through east (+x).
    #[schemars(extend("x-unit" = "°", "x-default" = "180"))]
    pub sun_azimuth: Option<f64>,
    /// Place on the earth, for the position of the sun.
    pub place: Option<PlaceFile>,
    /// Date and time with the offset from UTC, for the position of the sun, such as
    /// `2026-06-21T12:00:00+02:00`.
    #[schemars(extend("format" = "date-time"))]
    pub time: Option<String>,
    /// The sun as a light, in addition to the sky.
    pub sun: Option<SunFile>,
    /// Illuminance of a horizontal plane under the unobstructed sky, without the sun.
    #[schemars(range(min = 0), extend("x-unit" = "lx"))]
    pub illuminance: f64,
    /// Reflectance of the ground. All directions below the horizon have this share of the luminance
    /// of a white ground under the unobstructed sky.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0, max = 1))]
    pub ground_reflectance: f64,
    /// Relative distribution of the light over wavelength, of sky and ground.
    #[serde(default = "default_spectrum", skip_serializing_if = "is_default_spectrum")]
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
}

/// A place on the earth, and the orientation of the scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Place", example = json!({"latitude": 52.52, "longitude": 13.405, "heading": 20}))]
pub struct PlaceFile {
    /// Latitude, positive in the north.
    #[schemars(range(min = -90, max = 90), extend("x-unit" = "°"))]
    pub latitude: f64,
    /// Longitude, positive in the east.
    #[schemars(range(min = -180, max = 180), extend("x-unit" = "°"))]
    pub longitude: f64,
    /// Compass direction of the scene's −z axis, from true north through east.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "°"))]
    pub heading: f64,
}

/// The sun as a light: a uniform disk.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Sun", example = json!({"illuminance": 80_000, "spectrum": "D55", "angular_diameter": 0.53, "group": "sun"}))]
pub struct SunFile {
    /// Illuminance on a surface that faces the sun. The default is 127 500 lx · exp(−0.21/sin γ) at
    /// the elevation γ (IES RP-21). It exists only for the clear skies: types 11 to 15.
    #[schemars(range(min = 0), extend("x-unit" = "lx", "x-default" = "of a clear sky"))]
    pub illuminance: Option<f64>,
    /// Relative distribution of the light over wavelength.
    #[serde(default = "default_sun_spectrum", skip_serializing_if = "is_default_sun_spectrum")]
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Angular diameter of the disk.
    #[serde(default = "default_diameter", skip_serializing_if = "is_default_diameter")]
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub angular_diameter: f64,
    /// Name of the light's group.
    #[schemars(extend("x-default" = "the group of the sky"))]
    pub group: Option<String>,
}

/// Returns daylight of 5503 K.
fn default_sun_spectrum() -> SpectrumFile {
    SpectrumFile::Name("D55".to_string())
}

fn is_default_sun_spectrum(spectrum: &SpectrumFile) -> bool {
    *spectrum == default_sun_spectrum()
}

/// Returns the mean angular diameter of the sun in degrees.
fn default_diameter() -> f64 {
    0.53
}

fn is_default_diameter(diameter: &f64) -> bool {
    *diameter == default_diameter()
}

/// Returns daylight of 6504 K.
fn default_spectrum() -> SpectrumFile {
    SpectrumFile::Name("D65".to_string())
}

fn is_default_spectrum(spectrum: &SpectrumFile) -> bool {
    *spectrum == default_spectrum()
}

impl SkyFile {
    /// A sky has no transform.
    pub(super) const TRANSFORM: &'static TransformFile = &TransformFile(Vec::new());

    /// Returns the position of the sun in the scene, with the azimuth counted from the axis −z, or
    /// `None` if the sky has none. A malformed `time` is an error.
    pub fn sun_position(&self) -> Result<Option<SunPosition>> {
        if let (Some(place), Some(time)) = (&self.place, &self.time) {
            let PlaceFile { latitude: latitude_deg, longitude: longitude_deg, heading } = *place;
            let SunPosition { direction, distance_au } =
                SunPosition::at(GeographicPlace { latitude_deg, longitude_deg }, date_time::julian_day(time)?);
            let azimuth = direction.azimuth - heading.to_radians();
            return Ok(Some(SunPosition { direction: SunDirection { azimuth, ..direction }, distance_au }));
        }
        let of_elevation = |elevation: f64| {
            let azimuth = self.sun_azimuth.unwrap_or(DEFAULT_AZIMUTH_DEG).to_radians();
            SunPosition { direction: SunDirection { elevation: elevation.to_radians(), azimuth }, distance_au: 1.0 }
        };
        Ok(self.sun_elevation.map(of_elevation))
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { kind, sun_elevation, place, illuminance, ground_reflectance, spectrum, sun, .. } = self;
        let elevation = sun_elevation.map_or(Ok(()), |elevation| {
            let inside = (0.0..=90.0).contains(&elevation);
            check::rule(&at.key("sun_elevation"), elevation, inside, "a number from 0 to 90")
        });
        check::all([
            check::count(&at.key("type"), u64::from(*kind), 1, 16),
            elevation,
            place.as_ref().map_or(Ok(()), |place| place.validate(&at.key("place"))),
            self.validate_sun_position(at),
            check::not_negative(&at.key("illuminance"), *illuminance),
            check::fraction(&at.key("ground_reflectance"), *ground_reflectance),
            spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            sun.as_ref().map_or(Ok(()), |sun| sun.validate(&at.key("sun"), *kind)),
        ])
    }

    /// Checks that there is at most one position of the sun, above the horizon if it matters.
    fn validate_sun_position(&self, at: &JsonPath) -> Result<()> {
        let by_place = self.place.is_some();
        if by_place != self.time.is_some() {
            let (one, other) = if by_place { ("place", "time") } else { ("time", "place") };
            return Err(check::fault(at, format!("found `{one}` without `{other}`"), "both keys"));
        }
        for (key, explicit) in [("sun_elevation", self.sun_elevation), ("sun_azimuth", self.sun_azimuth)] {
            if by_place && explicit.is_some() {
                let what = format!("found `{key}` beside `place` and `time`");
                return Err(check::fault(&at.key(key), what, "no such key"));
            }
        }
        let position = self.sun_position().map_err(|error| error.on_path(at.key("time").to_string()))?;
        let needed = match &self.sun {
            Some(_) => Some("the key `sun`".to_string()),
            None => StandardSky::depends_on_sun(self.kind).then(|| format!("a sky of type {}", self.kind)),
        };
        let Some(needed) = needed else { return Ok(()) };
        let Some(position) = position else {
            let what = format!("missing key \"sun_elevation\" for {needed}");
            return Err(check::fault(at, what, "the elevation of the sun in degrees, or `place` and `time`"));
        };
        let elevation = position.direction.elevation.to_degrees();
        if by_place && elevation <= 0.0 {
            let what = format!("the sun is {:.1}° below the horizon at this time", -elevation);
            let expected = format!("a time of day for {needed}");
            return Err(check::fault(&at.key("time"), what, expected));
        }
        Ok(())
    }
}

impl PlaceFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let range = |key: &str, value: f64, most: f64| {
            let allowed = format!("a number from {} to {}", -most, most);
            check::rule(&at.key(key), value, (-most..=most).contains(&value), &allowed)
        };
        check::all([range("latitude", self.latitude, 90.0), range("longitude", self.longitude, 180.0)])
    }
}

impl SunFile {
    /// `kind` is the number of the sky type.
    fn validate(&self, at: &JsonPath, kind: u32) -> Result<()> {
        let illuminance = match self.illuminance {
            Some(illuminance) => check::not_negative(&at.key("illuminance"), illuminance),
            None if CLEAR_SKIES.contains(&kind) => Ok(()),
            None => {
                let what = format!("missing key \"illuminance\" for the sun of a sky of type {kind}");
                Err(check::fault(at, what, "an illuminance in lx, or a clear sky (type 11 to 15)"))
            }
        };
        let inside = (0.0..180.0).contains(&self.angular_diameter);
        let allowed = "a number of at least 0 and below 180";
        check::all([
            illuminance,
            check::rule(&at.key("angular_diameter"), self.angular_diameter, inside, allowed),
            self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
        ])
    }
}
